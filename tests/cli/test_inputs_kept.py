"""No command replaces a file that it reads."""

from __future__ import annotations

from pathlib import Path

import pytest
from robots.public_arms import arms, urdf
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import InputError

LOG = Path(irb.__file__).parent / "data" / "arm" / "identification.csv.gz"
PART = "x_mm,y_mm,z_mm,i,j,k\n" + "".join(f"{900 + 5 * k},0,700,0,0,1\n" for k in range(20))


def refused(*words: object) -> str:
    error = CliRunner().invoke(app, [*map(str, words)]).exception
    assert isinstance(error, InputError), error
    return str(error)


@pytest.mark.parametrize("verb", ["diagnose", "identify"])
def test_the_robot_file_that_is_read_stays(verb: str, tmp_path: Path) -> None:
    own = tmp_path / "robot.toml"
    irb.save_robot(irb.load_robot("irb2400"), own)
    before = own.read_bytes()
    says = refused(verb, LOG, "--robot", own, "--out", tmp_path)
    assert f"found {own}, which this command reads and would replace" in says
    assert own.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["robot.toml"]


def test_it_stays_whichever_way_it_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    irb.save_robot(irb.load_robot("irb2400"), Path("robot.toml"))
    for out in (".", tmp_path):
        says = refused("identify", LOG, "--robot", "robot.toml", "--out", out)
        assert "found robot.toml, which this command reads and would replace" in says


def test_a_motion_or_a_path_stays(tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("not looked at")
    assert "would replace" in refused("simulate", log, "--controller", "pid", "--out", tmp_path)
    path = tmp_path / "trajectory.csv"
    path.write_text(PART)
    assert "would replace" in refused("plan", path, "--out", tmp_path)
    assert path.read_text() == PART


def test_an_imported_file_stays(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    text = urdf(arms()["ur10e"])
    path.write_text(text)
    assert "would replace" in refused("robot", "import", path, "--out", path)
    assert path.read_text() == text
    says = refused(
        "robot", "import", path, "--out", tmp_path / "a.toml", "--payload-com-mm", "0,0,9"
    )
    assert "no mass, expected --payload-kg" in says
    says = refused("robot", "import", path, "--out", tmp_path / "a.toml", "--coupling", "3.7,2,-1")
    assert "'3.7,2,-1', expected the numbers of two joints" in says
    assert not (tmp_path / "a.toml").exists()


def test_a_template_replaces_nothing(tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text("# edited for a day\n")
    assert "found it already, expected a new name" in refused("robot", "new", "--out", own)
    assert own.read_text() == "# edited for a day\n"


def test_a_robot_file_is_no_urdf(tmp_path: Path) -> None:
    own = tmp_path / "robot.toml"
    irb.save_robot(irb.load_robot("irb2400"), own)
    says = refused("robot", "import", own, "--out", tmp_path / "a.toml")
    assert "is not XML" in says
    assert "expected a URDF, an MJCF, or a DH table" in says
