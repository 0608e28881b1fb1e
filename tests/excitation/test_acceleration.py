"""Every motion that `excite` writes keeps the accelerations of the robot file, or what is assumed
where it states none."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest
from typer.testing import CliRunner

from irb2400_ctrl import excitation
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.excitation import (
    Budget,
    IdentificationMotion,
    excite,
    excite_identification,
    friction_runs,
)
from irb2400_ctrl.excitation.feasible import between
from irb2400_ctrl.excitation.friction_runs import there_and_back
from irb2400_ctrl.formats import ExcitationFile
from irb2400_ctrl.robot import Robot, load_robot
from irb2400_ctrl.trajectory import Trajectory

STEP = 1 / 250
FEW = Budget(pool=2, rounds=0, mutations=0)
SLOW = 150.0
"""[deg/s2]: slow runs feel it too"""


def arm(limit: float | None) -> Robot:
    """A UR10e whose joints state an acceleration [deg/s2], or none."""
    robot = load_robot("ur10e")
    joints = []
    for joint in robot.joints:
        limits = joint.limits.model_copy(update={"acceleration_deg_s2": limit})
        joints.append(joint.model_copy(update={"limits": limits}))
    return robot.model_copy(update={"joints": tuple(joints)})


@cache
def planned(limit: float | None) -> IdentificationMotion:
    # runs of few and fast speeds: those that ask for an acceleration
    with mock.patch.multiple(friction_runs, SPEEDS=3, SLOWEST=0.05):
        return excite_identification(arm(limit), seconds=16.0, budget=FEW)


def largest(course: Trajectory) -> np.ndarray:
    """Of each joint, by the rows' own column, between them, and by the rows' speeds [rad/s2]."""
    at = np.linspace(0.0, course.duration, 5 * len(course.time))
    dense = between(course, at)[2]
    steps = np.diff(course.qd, axis=0) / STEP
    return np.max([np.abs(values).max(axis=0) for values in (course.qdd, dense, steps)], axis=0)


def test_what_the_file_states_is_kept() -> None:
    found = planned(SLOW)
    for course in (found.course, found.runs.course):
        assert (np.degrees(largest(course)) <= SLOW * (1 + 1e-9)).all()
    # and used: a motion that stands keeps every limit
    assert np.degrees(largest(found.course)).max() > 0.8 * SLOW
    told = found.summary()
    assert told["acceleration_limits_deg_s2"] == pytest.approx([SLOW] * 6)
    assert told["acceleration_assumed_of_joints"] == []
    assert 0.8 < told["max_acceleration_ratio"] <= 1.0
    assert not any("assumed" in line for line in found.lines())


def test_without_one_the_speed_limit_takes_a_tenth_of_a_second() -> None:
    """A wrist of 2e-4 kg m2 was stopped from 97 deg/s within one row."""
    found = planned(None)
    limit = found.robot.qd_max / 0.1
    for course in (found.course, found.runs.course):
        assert (largest(course) <= limit * (1 + 1e-9)).all()
    told = found.summary()
    assert told["acceleration_limits_deg_s2"] == pytest.approx(np.degrees(limit))
    assert told["acceleration_assumed_of_joints"] == [1, 2, 3, 4, 5, 6]
    (line,) = [line for line in found.lines() if line.startswith("assumed")]
    assert "every joint: 1200, 1200, 1800, 1800, 1800, 1800 deg/s2 (speed limit in 0.1 s)" in line
    assert sum("acceleration" in line and "% of its limit" in line for line in found.lines()) == 2
    assert ExcitationFile.model_validate(told)


def test_a_motion_for_look_alikes_keeps_it_too() -> None:
    found = excite(arm(SLOW), "offset", joint=6, seconds=16.0, budget=FEW)
    assert (np.degrees(largest(found.course)) <= SLOW * (1 + 1e-9)).all()
    assert found.summary()["max_acceleration_ratio"] <= 1.0
    assert "acceleration" in found.lines()[1]


@pytest.mark.parametrize(("share", "inside"), [(1.0, True), (1.001, False)])
def test_a_motion_beyond_it_is_not_inside(share: float, inside: bool) -> None:
    found = replace(planned(None).extent, acceleration=share)
    assert found.inside == inside
    assert ("acceleration_deg_s2" in found.wrong()) != inside


@pytest.mark.parametrize("speed", [0.001, 0.1, 0.5])
@pytest.mark.parametrize("limit", [0.3, 2.0])
def test_slow_runs_of_one_joint_keep_it(speed: float, limit: float) -> None:
    rows = there_and_back(speed, limit)
    assert np.abs(rows[:, 2]).max() <= limit
    assert np.abs(np.diff(rows[:, 1])).max() <= limit * STEP * (1 + 1e-9)
    # as long at the speed as without it
    level = [np.isclose(states[:, 1], speed).sum() for states in (rows, there_and_back(speed))]
    assert abs(level[0] - level[1]) <= 2


def test_identify_has_a_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def made(robot: Robot, **asked: Any) -> IdentificationMotion:
        return planned(None)

    monkeypatch.setattr(excitation, "excite_identification", made)
    # the other files are looked at elsewhere
    monkeypatch.setattr(IdentificationMotion, "write", lambda found, out: [])
    folder = tmp_path / "motion"
    asked = ["excite", "--for", "identify", "--robot", "ur10e", "--seconds", "10", "--json"]
    done = CliRunner().invoke(app, [*asked, "--out", str(folder)])
    assert done.exit_code == 0, done.output
    report = folder / "report.html"
    assert str(report) in json.loads(done.stdout)["written"]
    page = report.read_text(encoding="utf-8")
    for part in (
        "acceleration, at most",
        "condition number",
        "What it identifies",
        "coulomb_3",
        "of assumed 1800 (",
        "irb2400 identify MOTION_LOG RUNS_LOG --robot ur10e --out arm",
        "acceleration 6 [deg/s²]",
        "Slow runs",
    ):
        assert part in page, part
