"""What `irb2400 plan` says on the terminal of what is in its files, and of its robot's numbers."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from command_line import irb2400

from irb2400_ctrl import load_robot
from irb2400_ctrl.cli.options import load_arm, settings
from irb2400_ctrl.robot import save_robot

PATH = "x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n0,0,0,0,0,1,800\n200,0,0,0,0,1,800\n200,150,0,0,0,1,800\n"
PLACE = ("--work-frame", "600,100,200,0,0,0")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("told")
    (found / "path.csv").write_text(PATH)
    return found


def said(folder: Path, *options: str) -> str:
    done = irb2400("plan", "path.csv", "--robot", "ur10e", *PLACE, *options, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_linked_plan_says_its_clearance_and_its_deviation(folder: Path) -> None:
    rows = ("--interpolation", "linear", "--rate", "50")
    told = said(folder, "--links", *rows, "--out", "links")
    assert "clearance: not known, the robot file has no [outline]" in told
    most = json.loads((folder / "links" / "plan.json").read_text())["max_tcp_deviation_mm"]
    assert most > 0.055
    assert f"the TCP leaves the path by up to {most:.3f} mm, 0.05 mm were asked for" in told
    assert "straight between rows the TCP cuts curves" in told
    # the report is what is passed on, and its head said that all is well
    assert f"leaves the path by up to {most:.3f} mm" in (folder / "links/report.html").read_text()
    names = ("program.json", "trajectory.csv", "plan.json", "report.html")
    assert f"written: {', '.join(f'links/{name}' for name in names)} and a folder per" in told


def test_an_acceleration_is_told_beside_speed_and_torque(folder: Path) -> None:
    limits = [f"--set=joints.{n}.limits.acceleration_deg_s2=300" for n in range(1, 7)]
    told = said(folder, *limits, "--out", "slow")
    summary = json.loads((folder / "slow" / "plan.json").read_text())
    assert f", acceleration {100 * summary['max_acceleration_ratio']:.1f} %; guaranteed" in told
    assert "the TCP leaves the path" not in told
    assert "acceleration, at most" in (folder / "slow" / "report.html").read_text()


def test_rapid_of_another_makers_arm_says_so(folder: Path) -> None:
    told = said(folder, "--rapid", "--out", "rapid")
    assert "note: program.mod is RAPID, which only ABB's controllers run" in told
    head = (folder / "rapid" / "program.mod").read_text().splitlines()[:3]
    assert head[2].endswith("axis 3 counts from the upper arm.")


def with_wide_ranges(path: Path, joints: int) -> str:
    """A file of a UR10e whose first joints turn in ranges that are radians taken for degrees."""
    robot = load_robot("ur10e")
    wide = {"range_deg": (-10313.2, 10313.2)}
    changed = tuple(
        j.model_copy(update={"limits": j.limits.model_copy(update=wide)}) if k < joints else j
        for k, j in enumerate(robot.joints)
    )
    save_robot(robot.model_copy(update={"joints": changed}), path)
    return str(path)


def test_what_looks_wrong_in_a_robot_file_is_told_by_commands(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    load_arm(with_wide_ranges(tmp_path / "wide.toml", joints=6))
    told = capsys.readouterr().err
    assert told.count("range -10313.2 to 10313.2 deg is several turns") == 3
    assert "and 3 more that look wrong (irb2400 robot check)" in told


def test_published_numbers_are_not_told_each_time(capsys: pytest.CaptureFixture[str]) -> None:
    load_arm("irb2400")
    assert capsys.readouterr().err == ""
    asked = settings.set(["joints.2.limits.speed_deg_s=5000"])
    try:
        load_arm("irb2400")
    finally:
        settings.reset(asked)
    assert capsys.readouterr().err.count("\n") == 1


def test_bodies_that_cannot_exist_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file that a diagnosis of the published robot wrote told four with every command."""
    robot = load_robot("irb2400")
    links = tuple(
        link.model_copy(update={"body": link.body.model_copy(update={"com_m": (0.01, 0.0, 0.0)})})
        for link in robot.links
    )
    save_robot(robot.model_copy(update={"links": links}), tmp_path / "found.toml")
    load_arm(str(tmp_path / "found.toml"))
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "link_2, link_3, link_4 and link_6: bodies that cannot exist" in told


def test_how_far_an_axis_is_out_is_the_difference_of_the_numbers_told(tmp_path: Path) -> None:
    """98.2 deg was 33.4 deg beyond a range that ended at 65 deg."""
    (tmp_path / "near.csv").write_text("x_mm,y_mm,z_mm,i,j,k\n0,0,0,0,0,1\n50,0,0,0,0,1\n")
    done = irb2400("plan", "near.csv", "--out", "out", cwd=tmp_path)
    assert done.returncode == 2
    assert "irb2400 place looks for one" in done.stderr
    numbers = [float(one) for one in re.findall(r"-?[0-9]+[.][0-9]", done.stderr)]
    assert numbers[0] - numbers[3] == pytest.approx(numbers[1], abs=0.11)


def test_one_more_that_looks_wrong_is_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    load_arm(with_wide_ranges(tmp_path / "wide.toml", joints=4))
    assert "and 1 more that looks wrong (irb2400 robot check)" in capsys.readouterr().err
