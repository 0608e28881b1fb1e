"""A motion that was planned for another arm is told by the torques that came with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.simulation.reference_check import planned_for_another
from irb2400_ctrl.trajectory import Trajectory

ROBOT = irb.load_robot("irb2400")
PAYLOAD = LIBRARY["payload"].of(None, mass_kg=20.0, com_m=(0.05, 0.0, 0.15))


def planned() -> Trajectory:
    time = np.linspace(0.0, 2.0, 101)
    swing = np.sin(time)[:, None] ** 2 * np.array([0.8, 0.5, -0.4, 1.2, 0.6, -1.0])
    motion = irb.simulation.from_angles(time, swing + np.array([0.0, 0.1, 0.0, 0.2, 0.6, 0.0]))
    tau = irb.Model(ROBOT).inverse_dynamics(motion.q, motion.qd, motion.qdd)
    return replace(motion, tau=tau)


def test_another_arm_is_told() -> None:
    said = planned_for_another(irb.load_robot("ur10e"), planned())
    assert said is not None
    assert "not those of Universal Robots UR10e" in said


def test_the_same_arm_with_more_load_or_without_torques_is_not() -> None:
    assert planned_for_another(ROBOT, planned()) is None
    assert planned_for_another(ROBOT.with_effects(PAYLOAD), planned()) is None
    assert planned_for_another(irb.load_robot("ur10e"), replace(planned(), tau=None)) is None
