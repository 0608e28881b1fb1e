"""What the controller reads from the file of a plan stays within what the plan says of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_plans import drawn_path, looked_at
from spline_paths import random_path

from irb2400_ctrl import load_robot
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import MotionLimits, builders, plan_path, time_joint_path
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.timing.sampled_reference import SampledReference

ROBOT = load_robot("irb2400")
DYNAMICS = path_dynamics(ROBOT)
LIMITS = MotionLimits.of(ROBOT)


@pytest.mark.parametrize("seed", range(10))
def test_no_bound_of_the_file_lies_below_the_truth(seed: int, tmp_path: Path) -> None:
    way: Any = "linear" if seed % 2 else "cubic"
    plan = plan_path(ROBOT, drawn_path(seed), free_tool_rotation=False, interpolation=way)
    assert plan.guaranteed
    assert plan.max_torque_ratio <= 1
    assert looked_at(plan, ROBOT, tmp_path).above(plan) == []


@pytest.mark.parametrize("interpolation", ["cubic", "linear"])
@pytest.mark.parametrize("seed", range(3))
def test_bounds_hold_and_are_sharp_for_a_law_that_jumps(seed: int, interpolation: Any) -> None:
    path = random_path(seed)
    law = time_joint_path(DYNAMICS, path, LIMITS)[0]
    reference = SampledReference.of(law, path, 250.0, interpolation).as_written()
    bounds = reference.bounds(DYNAMICS, LIMITS)
    time = np.arange(0.0, reference.rows.time[-1], 2e-5)
    q, qd, qdd = reference.states(time)
    tau = np.abs(DYNAMICS.model.inverse_dynamics(q, qd, qdd))
    seen = float((tau / LIMITS.tau_max).max())
    assert seen <= bounds.torque_ratio(LIMITS.tau_max) <= 1.01 * seen
    fastest = float((np.abs(qd) / LIMITS.qd_max).max())
    assert fastest <= bounds.velocity_ratio(LIMITS.qd_max) <= 1.001 * fastest
    # a torque that jumps swings above its limit between the rows
    assert seen > 1.002
    whole = bounds.largest
    assert whole.torque.shape == (1, ROBOT.n)
    assert whole.torque_ratio(LIMITS.tau_max) == bounds.torque_ratio(LIMITS.tau_max)
    assert whole.velocity_ratio(LIMITS.qd_max) == bounds.velocity_ratio(LIMITS.qd_max)
    assert whole.time.tolist() == [bounds.time[0], bounds.time[-1]]


def test_the_file_keeps_what_it_says() -> None:
    plan = plan_path(ROBOT, drawn_path(1), free_tool_rotation=False)
    written = plan.trajectory
    assert written.as_written().csv() == written.csv()
    # with the nine digits of other columns the angles' rounding would count
    coarse = replace(written, q=np.radians(np.round(np.degrees(written.q), 5)), check_speeds=False)
    jumps = SampledReference(coarse, "cubic").bounds(DYNAMICS, LIMITS)
    assert jumps.torque_ratio(ROBOT.tau_max) > 1.0005 * plan.max_torque_ratio


def test_plan_says_what_it_speaks_of() -> None:
    path = builders.line((0.9, 0, 0.5), (0.9, 0.2, 0.5))
    plan = plan_path(ROBOT, path, torque_share=0.8, interpolation="linear")
    said = plan.summary()
    assert said["schema_version"] == 2
    assert said["torque_share"] == 0.8
    assert said["interpolation"] == "linear"
    # against the robot's own limits, not the tighter ones of the plan
    assert 0.79 < said["max_torque_ratio"] <= 0.8
    with pytest.raises(InputError, match="interpolation: found 'quintic', expected one of cubic"):
        plan_path(ROBOT, path, interpolation="quintic")
    with pytest.raises(InputError, match="torque share: found 90"):
        plan_path(ROBOT, path, torque_share=90)


def test_a_torque_that_jumps_is_slowed_until_its_file_is_safe() -> None:
    path = builders.line((0.9, 0, 0.5), (0.9, 0.2, 0.5))
    jumping = plan_path(ROBOT, path, free_tool_rotation=False, torque_rate=np.inf)
    followed = plan_path(ROBOT, path, free_tool_rotation=False)
    assert jumping.guaranteed
    assert followed.guaranteed
    tau = Model(ROBOT).inverse_dynamics(
        *jumping.reference.states(np.arange(0.0, jumping.trajectory.time[-1], 1e-4))
    )
    assert (np.abs(tau) / ROBOT.tau_max).max() <= jumping.max_torque_ratio <= 1
