"""The prior of a robot file, seen and changed on the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.cli.options import load_arm
from irb2400_ctrl.errors import InputError

LOG = Path(irb.__file__).parent / "data" / "arm" / "validation.csv.gz"


def test_numbers_are_replaced_one_by_one() -> None:
    u = load_arm("irb2400", ["mass_relative=0.1", "link_2.com_m = 0.02", "tool.com_m=0.03"])
    assert u.uncertainty.mass_relative == 0.1
    assert u.uncertainty.com_m == irb.load_robot("irb2400").uncertainty.com_m
    assert u.uncertainty.of_body("link_2") == (0.1, 0.02, 0.05)
    assert u.uncertainty.of_body("tool")[1] == 0.03
    assert "link_2 10 %, 20 mm, 5 %" in u.uncertainty.says()
    assert load_arm("irb2400") == irb.load_robot("irb2400")


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("mass=0.1", "expected one of mass_relative, com_m"),
        ("link_9.com_m=0.1", "one of the bodies link_1, link_2"),
        ("link_2.friction_relative=0.1", "expected one of mass_relative, com_m, inertia_relative"),
        ("com_m=-1", "found '-1', expected a number above zero"),
        ("com_m=ten", "found 'ten'"),
        ("com_m", "found ''"),
        ("com_m=inf", "found 'inf'"),
        ("links=3", "found 'links'"),
    ],
)
def test_what_cannot_be_is_refused(entry: str, says: str) -> None:
    with pytest.raises(InputError, match="uncertainty") as error:
        load_arm("irb2400", [entry])
    assert says in str(error.value)


def test_show_prints_the_prior() -> None:
    said = CliRunner().invoke(app, ["robot", "show", "puma560"]).output
    assert "masses 2 %, centres of mass 5 mm, inertias 5 %, friction 4 %" in said


def test_identify_takes_and_writes_the_prior(tmp_path: Path) -> None:
    moved = {}
    for name, extra in (("file", []), ("wide", ["--uncertainty", "mass_relative=0.5"])):
        out = tmp_path / name
        run = CliRunner().invoke(app, ["identify", str(LOG), "--out", str(out), *extra])
        assert run.exit_code == 0, run.output
        assert f"masses {50 if extra else 2} %" in run.output
        found = irb.load_robot(out / "robot.toml")
        assert found.uncertainty.mass_relative == (0.5 if extra else 0.02)
        moved[name] = [link.body.mass_kg for link in found.links]
        assert json.loads((out / "identification.json").read_text())
    assert moved["file"] != pytest.approx(moved["wide"], rel=1e-3)
