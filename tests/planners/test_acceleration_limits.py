"""Accelerations and torque rates that the robot file limits: kept by the rows, and stated."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl import Model, load_robot
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners import Plan, ToolPath, check, plan_path
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.joint_plan import plan_joints
from irb2400_ctrl.planners.timing import path_timer, time_choices
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.robot import Robot

MOST = 300.0
"""[deg/s2], far below what the torques of the arm would allow"""


def limited(name: str = "ur10e", **stated: float) -> Robot:
    """The arm with further limits of every joint."""
    robot = load_robot(name)
    joints = tuple(
        j.model_copy(update={"limits": j.limits.model_copy(update=stated)}) for j in robot.joints
    )
    return robot.model_copy(update={"joints": joints})


def corner() -> ToolPath:
    points = np.array([[0.5, -0.3, 0.3], [0.5, 0.3, 0.3], [0.8, 0.3, 0.3]])
    return builders.way_points(points, np.tile([0.0, 0.0, 1.0], (3, 1)), feed=0.8)


def largest(plan: Any) -> tuple[float, float]:
    """Of the column and of the cubics through angles and speeds [deg/s2]."""
    rows = plan.trajectory
    cubic = JointPath.hermite(rows.time, rows.q, rows.qd)
    piece = np.arange(len(rows.time) - 1)
    ends = (rows.time[:-1], rows.time[1:])
    bend = max(float(np.abs(cubic.on_piece(at, piece, 2)).max()) for at in ends)
    return float(np.degrees(np.abs(rows.qdd).max())), float(np.degrees(bend))


def planned(robot: Robot, **options: Any) -> Plan:
    return plan_path(robot, corner(), free_tool_rotation=False, cells=300, **options)


@pytest.mark.parametrize("longest", [1000, 1])
@pytest.mark.parametrize("interpolation", ["cubic", "linear"])
def test_rows_keep_the_accelerations_that_the_robot_file_limits(
    monkeypatch: pytest.MonkeyPatch, longest: int, interpolation: str
) -> None:
    # with a torque that may jump, as of a long path, the rows had 1.9 times the limit
    monkeypatch.setattr(time_choices, "RATES_UP_TO", longest)
    robot = limited(acceleration_deg_s2=MOST)
    plan = planned(robot, interpolation=interpolation)
    column, cubic = largest(plan)
    assert column <= MOST * (1 + 1e-6)
    read = column if interpolation == "linear" else max(column, cubic)
    assert read <= MOST * (1 + 1e-6)
    said = plan.summary()
    assert said["guaranteed"]
    np.testing.assert_allclose(said["max_acceleration_ratio"], read / MOST, rtol=1e-6)
    assert said["max_acceleration_ratio"] > 0.7
    found = check(plan.certificate, Model(robot))
    assert found.holds()
    assert found.acceleration_ratio > 0.5


def test_a_law_with_jumps_says_how_far_it_is_from_its_acceleration_limits() -> None:
    robot = limited(acceleration_deg_s2=MOST)
    plan = planned(robot, torque_rate=np.inf)
    certificate = plan.certificate
    tighter = replace(certificate.limits, qdd_max=certificate.limits.qdd_max / 2)
    found = check(replace(certificate, limits=tighter), Model(robot))
    own = check(certificate, Model(robot))
    np.testing.assert_allclose(found.acceleration_ratio, 2 * own.acceleration_ratio, rtol=1e-9)
    assert not found.holds()
    time = np.linspace(0, certificate.law.duration, 20_001)
    qdd = certificate.law.motion(certificate.path, time)[3]
    sampled = float((np.abs(qdd) / certificate.limits.qdd_max).max())
    assert sampled <= own.acceleration_ratio <= 1.02 * sampled


def test_without_such_a_limit_nothing_is_said_of_it() -> None:
    plan = planned(load_robot("ur10e"))
    assert plan.summary()["max_acceleration_ratio"] is None
    assert "jerk_limit_deg_s3" not in plan.summary()


def test_rows_above_a_limit_are_not_guaranteed() -> None:
    # toppra's timing is never slowed for its rows
    pytest.importorskip("toppra")
    plan = planned(limited(acceleration_deg_s2=MOST), timing="toppra")
    assert plan.summary()["max_acceleration_ratio"] > 1.1
    assert not plan.guaranteed
    assert "acceleration of an axis reaches" in plan.guarantee_note


@pytest.mark.parametrize("most", [MOST, 3.0])
def test_links_keep_them_too(most: float) -> None:
    """Where the limit is far below what the torque allows, cells at the ends were smaller than
    their rounding."""
    robot = limited(acceleration_deg_s2=most, torque_Nm=2000.0)
    timing = TimingOptions.of(robot, "certified", 200, None, None, None, Sampling(250.0, "cubic"))
    q = np.radians([[0, -90, 90, -90, -90, 0], [90, -60, 80, -110, -90, 40]])
    plane = ClearancePlane(np.array([0.0, 0.0, 1.0]), -1.0, 0.05)
    plan = plan_joints(robot, q[0], q[1], plane, timing)
    assert max(largest(plan)) <= most * (1 + 1e-6)
    assert plan.guaranteed
    assert plan.max_acceleration_ratio is not None
    assert 0.9 < plan.max_acceleration_ratio <= 1


def test_a_torque_rate_of_the_robot_file_is_kept() -> None:
    robot = limited(torque_rate_Nm_s=500.0)
    plan = planned(robot)
    change = np.abs(np.diff(plan.tau, axis=0)) * 250.0
    # the arm has no dry friction, which would jump; in steps between rows the rate is less
    assert change.max() <= 500.0 * 1.01
    assert change.max() > 400.0
    said = plan.summary()
    assert said["torque_rate_limit_Nm_s"] == pytest.approx([500.0] * 6)
    assert plan.guaranteed
    # what is asked for can only be less
    own = planned(robot, torque_rate=np.inf).summary()
    assert own["torque_rate_limit_Nm_s"] == pytest.approx([500.0] * 6)
    with pytest.raises(InputError, match="torque_rate_Nm_s of the robot file"):
        planned(robot, timing="toppra")


def test_room_for_the_rows_is_quicker_than_slowing_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows of a law that may jump swing by up to two thirds above its accelerations: without room
    the whole motion is slowed where slowing a few rows does not settle."""
    monkeypatch.setattr(time_choices, "RATES_UP_TO", 1)
    points = np.array([[0.9, -0.3, 0.8], [0.9, 0.3, 0.8], [1.2, 0.3, 0.8]])
    path = builders.way_points(points, np.tile([0.0, 0.0, 1.0], (3, 1)), feed=0.8)
    robot = limited("irb2400", acceleration_deg_s2=300.0)

    def seconds() -> float:
        plan = plan_path(robot, path, free_tool_rotation=False, cells=300)
        assert plan.guaranteed
        return plan.duration

    own = seconds()
    monkeypatch.setattr(path_timer.PathTimer, "roomy", lambda self, path, law: law)
    assert own < 0.9 * seconds()


def test_of_a_short_path_the_shorter_of_both_laws_is_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where only a few rows swing, slowing them costs less than room for all."""
    monkeypatch.setattr(time_choices, "RATES_UP_TO", 1)
    points = np.array([[0.5, -0.1, 0.3], [0.5, 0.0, 0.3]])
    path = builders.way_points(points, np.tile([0.0, 0.0, 1.0], (2, 1)), feed=0.3)
    robot = limited(acceleration_deg_s2=MOST)

    def seconds() -> float:
        plan = plan_path(robot, path, free_tool_rotation=False, cells=300)
        assert plan.guaranteed
        assert plan.max_acceleration_ratio is not None
        assert plan.max_acceleration_ratio <= 1
        return plan.duration

    own = seconds()
    monkeypatch.setattr(path_timer, "_SHORT", 0)
    assert own < 0.97 * seconds()
