"""Studies of arms that are not the IRB 2400."""

from __future__ import annotations

from pathlib import Path

import pytest
from simulation.planar_arm import planar
from sweep.studies import small

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.report.pages.sweep_page import sweep_page
from irb2400_ctrl.robot import save_robot
from irb2400_ctrl.sweep import run_sweep, simulate_case

FEW = """
name = "few"
robot = "{robot}"
draws = 1
seed = 1
[[controllers]]
controller = "computed_torque"
[[motions]]
name = "nod"
poses_deg = {poses}
speeds = [0.5]
"""


def test_a_study_of_two_axes_has_a_report(tmp_path: Path) -> None:
    """Its way was coloured by the margins of a wrist that it lacks."""
    save_robot(planar(), tmp_path / "planar.toml")
    study = small(tmp_path, FEW.format(robot="planar.toml", poses="[[0, 0], [20, -30]]"))
    page = sweep_page(run_sweep(study, tmp_path / "out", workers=1)).html()
    assert "smallest singular value" in page
    assert "wrist margin" not in page


def test_a_light_joint_with_much_friction_gets_the_time_steps_of_simulate(tmp_path: Path) -> None:
    """Puma 560 as it is shipped diverged in a study, and only there."""
    poses = "[[0, -45, -60, 0, 40, 0], [20, -25, -40, 60, -20, 90]]"
    run = simulate_case(small(tmp_path, FEW.format(robot="puma560", poses=poses)), 0)
    assert max(run.summary()["joint_error_deg"]["max"]) < 0.5


def test_gains_that_the_package_refuses_are_refused_in_a_study(tmp_path: Path) -> None:
    text = FEW.format(robot="puma560", poses="[[0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0]]")
    gains = 'controller = "computed_torque"\ngains = { kp = -1.0, kd = [1.0, 2.0] }'
    with pytest.raises(InputError) as said:
        small(tmp_path, text.replace('controller = "computed_torque"', gains))
    assert "gains, kp: found -1.0; expected at least 0.0" in str(said.value)
    assert "gains, kd: found shape (2,); expected one number, or (6,)" in str(said.value)


def test_an_end_stop_that_is_hit_is_told(tmp_path: Path) -> None:
    """A row said nothing of it."""
    save_robot(planar(), tmp_path / "planar.toml")
    text = FEW.format(robot="planar.toml", poses="[[0, 0], [20, -30]]")
    # without gains the arm falls under a load that nobody told
    limp = 'controller = "gravity_pd"\ngains = { kp = 0.0, kd = 0.0 }'
    text = text.replace('controller = "computed_torque"', limp)
    text = text.replace("[[controllers]]", "[payload]\nmass_kg = 5.0\n[[controllers]]")
    result = run_sweep(small(tmp_path, text + "hold_s = 2.0\n"), tmp_path / "out", workers=1)
    (row,) = result.rows
    (line,) = result.lines
    assert max(row["joint1_end_stop_share"], row["joint2_end_stop_share"]) > 0.05
    assert line.stopped == 1
    assert "at an end stop" in sweep_page(result).html()
