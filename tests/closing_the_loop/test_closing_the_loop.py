"""A finding makes the controller better on an arm that shares no code with the library, and really
has the effect.

`benchmarks/close_loop.py` does the same for more effects and arms; its table is in
docs/diagnosis.md.
"""

from __future__ import annotations

import numpy as np
import pytest
from independent_plant import Case, Effect

from irb2400_ctrl.robot import Robot, load_robot
from irb2400_ctrl.simulation import Trajectory, simulate

from .closing import Tracking, close, followed


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load_robot("irb2400")


@pytest.mark.parametrize("name", ["feedforward_pid", "computed_torque"])
def test_both_plants_agree_where_the_arm_is_the_papers(robot: Robot, name: str) -> None:
    """No spread, no effects: the library's plant and the independent one are the same arm."""
    case = Case(31, spread=0.0, duration=1.0, validation_duration=12.0)
    there = followed(case, name, robot, real="double")
    move = case.motions[1]
    qd = np.gradient(move.q, 1e-3, axis=0)
    motion = Trajectory(np.arange(len(qd)) / 1000, move.q, qd, np.gradient(qd, 1e-3, axis=0))
    here = simulate(robot, motion, name)
    skip = len(move.q) - len(there.q)
    np.testing.assert_allclose(here.p_BT_ref[skip:], there.tip_ref, atol=1e-9)
    errors = np.sqrt(((here.q - here.q_ref)[skip:] ** 2).mean(axis=0)), Tracking.of(there).joints
    # stick-slip is chaotic: the same torques to 1e-5 lead to other instants of breaking loose
    np.testing.assert_allclose(*errors, rtol=0.5)
    np.testing.assert_allclose(*(np.linalg.norm(e[:3]) for e in errors), rtol=0.15)


@pytest.mark.parametrize(
    ("kind", "joint"), [("gear_ripple", 4), pytest.param("balancer", 2, marks=pytest.mark.slow)]
)
def test_the_regenerated_controller_follows_better(robot: Robot, kind: str, joint: int) -> None:
    closed = close(
        Case(31, (Effect(kind, joint, 0.15),), validation_duration=15.0),
        robot,
        ("computed_torque",),
    )
    assert [(f.effect.kind, f.effect.joint) for f in closed.diagnosis.findings] == [(kind, joint)]
    given, recalibrated, diagnosed = (
        by_name["computed_torque"]
        for by_name in (closed.given, closed.recalibrated, closed.diagnosed)
    )
    axis = joint - 1
    assert diagnosed.joints[axis] < 0.5 * min(given.joints[axis], recalibrated.joints[axis])
    assert diagnosed.tip < 0.8 * given.tip
