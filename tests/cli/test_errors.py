"""What a user sees when the input is wrong: one or two lines, exit code 2, never a traceback."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command_line import irb2400

import irb2400_ctrl as irb
from irb2400_ctrl.cli.logs_in import WHAT, Reader, read_logs


def complaint(*arguments: object, cwd: Path) -> str:
    done = irb2400(*arguments, cwd=cwd)
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    return done.stderr


@pytest.mark.parametrize("command", ["plan", "diagnose", "simulate", "identify"])
def test_missing_file(command: str, tmp_path: Path) -> None:
    extra = ["--controller", "computed_torque"] if command == "simulate" else []
    text = complaint(command, "nowhere.csv", "--out", "out", *extra, cwd=tmp_path)
    assert "nowhere.csv" in text
    assert "expected" in text
    assert not (tmp_path / "out").exists()
    if command in ("diagnose", "identify"):
        assert WHAT in text


def write_log(path: Path, drop: str = "", nan_row: int | None = None) -> Path:
    names = ["time_s", *(f"q{j}_deg" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]
    time = np.arange(1000) / 250
    data = np.column_stack(
        [time, *(10 * np.sin(time * (1 + j)) for j in range(6)), *(np.cos(time) for _ in range(6))]
    )
    if nan_row is not None:
        data[nan_row, 3] = np.nan
    keep = [i for i, name in enumerate(names) if not (drop and name.startswith(drop))]
    rows = [
        ",".join(names[i] for i in keep),
        *(",".join(f"{row[i]:.6f}" for i in keep) for row in data),
    ]
    path.write_text("\n".join(rows) + "\n")
    return path


def test_log_without_torque(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.csv", drop="tau")
    text = complaint("diagnose", log, "--out", tmp_path / "out", cwd=tmp_path)
    assert "tau1_Nm" in text


def test_a_log_that_is_given_twice_counts_once(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.csv")
    again = tmp_path / "." / "log.csv"
    found = read_logs([log, again], Reader(None))
    assert len(found.logs) == 1
    assert [one.why for one in found.left_out] == ["given twice, counts once"]


def test_a_log_in_which_nothing_moves_identifies_nothing(tmp_path: Path) -> None:
    names = ["time_s", *(f"q{j}_deg" for j in range(1, 7)), *(f"tau{j}_Nm" for j in range(1, 7))]
    rows = [f"{k / 250:.3f}," + ",".join(["1.0"] * 12) for k in range(2500)]
    log = tmp_path / "still.csv"
    log.write_text("\n".join([",".join(names), *rows]) + "\n")
    text = complaint("identify", log, "--out", tmp_path / "out", cwd=tmp_path)
    assert "no joint moves, expected a motion" in text


@pytest.mark.parametrize("place", ["egm:", "egm://", "egm:///"])
def test_a_controller_without_a_name_is_asked_for(place: str, tmp_path: Path) -> None:
    assert "expected egm://HOST" in complaint("watch", place, cwd=tmp_path)


def test_nan_in_a_log_says_where(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.csv", nan_row=500)
    text = complaint("diagnose", log, "--out", tmp_path / "out", cwd=tmp_path)
    assert "q3_deg" in text
    assert "502" in text  # the line of the file: header, then row 500


def test_unreachable_path_names_point_and_distance(tmp_path: Path) -> None:
    path = tmp_path / "far.csv"
    path.write_text(
        "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n"
        "1000,0,800,0,0,1,20\n1000,50,800,0,0,1,20\n4000,100,800,0,0,1,20\n"
    )
    text = complaint("plan", path, "--out", tmp_path / "out", cwd=tmp_path)
    assert "point 3" in text
    assert "mm" in text


def test_robot_with_two_mistakes_reports_both(tmp_path: Path) -> None:
    good = irb.save_robot(irb.load_robot("irb2400"), tmp_path / "good.toml").read_text()
    bad = tmp_path / "bad.toml"
    bad.write_text(
        good.replace("mass_kg = 26.5", "mass_kg = -26.5").replace("speed_deg_s", "sped_deg_s", 1)
    )
    text = complaint("robot", "check", bad, cwd=tmp_path)
    assert "mass_kg" in text
    assert "-26.5" in text
    assert "did you mean speed_deg_s" in text


def test_unknown_controller_lists_the_known_ones(tmp_path: Path) -> None:
    text = complaint("codegen", "--controller", "magic", "--out", tmp_path / "out", cwd=tmp_path)
    assert "computed_torque" in text
    assert "momentum_observer" in text


def test_help_loads_no_heavy_package(tmp_path: Path) -> None:
    code = (
        "import sys; from irb2400_ctrl.cli import main; "
        "print([m for m in ('casadi', 'numpy', 'pydantic', 'toppra', 'control', 'matplotlib') if m "
        "in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
    assert irb2400("--help", cwd=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("simulate", "--controller", "pid", "--out", "out"), "a trajectory (CSV)"),
        (("diagnose", "--out", "out"), "a log"),
    ],
)
def test_a_cam_file_elsewhere_is_called_one(
    words: tuple[str, ...], expected: str, tmp_path: Path
) -> None:
    """A statement without commas was "1 cells, expected 3"."""
    (tmp_path / "part.apt").write_text("UNITS/MM\nSPINDL/12000,RPM,CLW\nGOTO/1,2,3,0,0,1\n")
    text = complaint(words[0], "part.apt", *words[1:], cwd=tmp_path)
    assert f"found a CAM file, expected {expected}" in text
    assert "irb2400 plan" in text


def test_a_start_that_cannot_be_is_refused_before_the_planning(tmp_path: Path) -> None:
    (tmp_path / "path.csv").write_text(
        "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n1000,0,900,0,0,1,50\n1000,9,900,0,0,1,50\n"
    )
    for start, said in (("0,1,2", "found 3 angles, expected 6"), ("0,0,500,0,0,0", "axis 3")):
        text = complaint("plan", "path.csv", "--start", start, "--out", "out", cwd=tmp_path)
        assert said in text
        assert not (tmp_path / "out").exists()
