"""A standard set of motions, and the torque by which two descriptions of an arm differ on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory.trajectory import RATE

SHARE = 0.6
"""of range and speed that the motions use [-]"""
DURATION = 10.0
UNKNOWN_SPEED = 1.0
"""[rad/s] of a joint whose speed limit the robot file does not state"""


@dataclass(frozen=True)
class StandardMotion:
    """A motion of all joints."""

    name: str
    q: Array
    qd: Array
    qdd: Array


def standard_motions(robot: Robot) -> list[StandardMotion]:
    """Each joint swinging alone, then all together (three mixtures of sines), inside range and
    speed limits; where a speed limit is unknown, at a radian a second."""
    fastest = np.where(np.isfinite(robot.qd_bound), robot.qd_bound, UNKNOWN_SPEED)
    time = np.arange(0.0, DURATION, 1 / RATE)
    middle = (robot.q_max + robot.q_min) / 2
    half = (robot.q_max - robot.q_min) / 2
    motions = []
    for i in range(robot.n):
        amplitude = SHARE * half * np.eye(robot.n)[i]
        frequency = np.full(robot.n, SHARE * fastest[i] / amplitude[i])
        motions.append(
            _sines(f"axis {i + 1} alone", time, middle, amplitude[None], frequency[None])
        )
    for seed in range(3):
        rng = np.random.default_rng(seed)
        share = rng.dirichlet(np.ones(3), robot.n).T
        frequency = rng.uniform(0.5, 2.0, (3, robot.n))
        amplitude = SHARE * share * np.minimum(half, fastest / frequency)
        motions.append(_sines(f"all axes, mixture {seed + 1}", time, middle, amplitude, frequency))
    return motions


def torque_differences(robot: Robot, other: Robot) -> dict[str, Array]:
    """Largest rigid-body torque of `other` less that of `robot` on each standard motion, by its
    name, per joint [Nm], shape (n,); friction is the same in both."""
    first = Model(robot)
    second = Model(other)
    found = {}
    for motion in standard_motions(robot):
        tau = first.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
        difference = second.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False) - tau
        found[motion.name] = np.abs(difference).max(axis=0)
    return found


def _sines(
    name: str, time: Array, middle: Array, amplitude: Array, frequency: Array
) -> StandardMotion:
    """q = middle + sum of amplitude sin(frequency t); amplitude and frequency [rad, rad/s], shape
    (terms, n)."""
    angle = time[:, None, None] * frequency
    q = middle + (amplitude * np.sin(angle)).sum(axis=1)
    qd = (amplitude * frequency * np.cos(angle)).sum(axis=1)
    qdd = -(amplitude * frequency**2 * np.sin(angle)).sum(axis=1)
    for array in (q, qd, qdd):
        array.setflags(write=False)
    return StandardMotion(name, q, qd, qdd)
