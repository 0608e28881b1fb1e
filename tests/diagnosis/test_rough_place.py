"""A place where a gear is rough is no set of ripples."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from independent_plant.native import inverse_dynamics
from independent_plant.parameters import paper_arm

from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import load_robot

Array = npt.NDArray[np.float64]

ROBOT = load_robot("irb2400")
TIME = np.arange(0.0, 20.0, 0.008)
HALF = np.radians([60.0, 35.0, 35.0, 90.0, 70.0, 120.0])
NOISE = np.array([1.2, 1.5, 0.9, 0.3, 0.3, 0.15])
"""[Nm]"""
JOINT = 1
"""axis 2, from 0"""
ORDER = 40.0
WIDTH = np.radians(8.0)
"""of the place"""


def diagnosed(ripple: Array, q: Array, qd: Array, qdd: Array) -> Diagnosis:
    """What is said of the paper's arm with a further torque of axis 2, shape (m,) [Nm]."""
    tau = inverse_dynamics(paper_arm().packed(), q, qd, qdd)
    for j, joint in enumerate(ROBOT.joints):
        friction = joint.friction
        tau[:, j] += friction.coulomb_Nm * np.tanh(qd[:, j] / 1e-3)
        tau[:, j] += friction.viscous_Nms_rad * qd[:, j]
    tau[:, JOINT] += ripple
    noise = np.random.default_rng(11).standard_normal(q.shape) * NOISE
    return diagnose(ROBOT, Log(TIME, q, tau + noise, q_ref=q))


def motion() -> tuple[Array, Array, Array]:
    """Three sines on each joint, shape (m, 6) each."""
    rng = np.random.default_rng(10)
    pulse = 2.0 * np.pi * rng.uniform(0.08, 0.35, (3, 1, 6))
    size = HALF * rng.uniform(0.15, 0.4, (3, 1, 6))
    phase = pulse * TIME[:, None] + rng.uniform(0.0, 2.0 * np.pi, (3, 1, 6))
    q = (size * np.sin(phase)).sum(0)
    qd = (size * pulse * np.cos(phase)).sum(0)
    return q, qd, -(size * pulse**2 * np.sin(phase)).sum(0)


@pytest.mark.parametrize("rough", [True, False])
def test_a_ripple_in_one_place_of_an_axis_has_no_name(rough: bool) -> None:
    """It was three ripples of orders 34, 41 and 47 at 0.92 to 0.95."""
    q, qd, qdd = motion()
    angle = q[:, JOINT]
    height = np.exp(-(((angle - 0.1) / WIDTH) ** 2)) if rough else 0.5
    found = diagnosed(30.0 * height * np.sin(ORDER * angle), q, qd, qdd)
    names = [(one.effect.kind, one.effect.joint) for one in found.findings]
    rest = [(one.joint, one.depends_on) for one in found.unexplained]
    assert names == ([] if rough else [("gear_ripple", JOINT + 1)])
    assert rest == ([(JOINT + 1, ("q",))] if rough else [])
    if rough:
        assert found.unexplained[0].description == "ripple of order 40, higher at some angles"
