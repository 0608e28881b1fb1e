"""Joints that rest in a log: their torque holds the arm up, but for what dry friction holds.

|tau_j - g_j(q)| <= F_s (eq. 54 at qd = 0) is no law of the joint, but a bound on the bodies and on
all that is found: it must leave the arm held up. As a normal variable the friction of such a joint
has a mean over a log and changes of its own (`NoiseModel.holds`), each of standard deviation F_s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.diagnosis.preparation.noise import rests
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

BELIEVED = 3.0
"""standard deviations of a robot's numbers and of its friction, beyond which something else holds a
joint: a brake"""
HELD_OTHERWISE = (
    "joint {joint} rests, and its torque is not what holds the arm there (a brake, or a load that "
    "is not stated): it bears no witness"
)


def held_at_rest(robot: Robot) -> Array:
    """What dry friction holds of each joint that rests: F_s, and never less than the F_c of its
    motion; infinity where the file states none, shape (n,) [Nm]."""
    holds = robot.friction[:, :2].max(axis=1)
    return np.asarray(np.where(robot.friction_stated[:, 1], holds, np.inf))


@dataclass(frozen=True)
class Resting:
    """What the joints that rest say.

    Args:
        holds: how much dry friction may hold of each joint that bears witness, shape (n,), infinity
            of the others [Nm].
        columns: of the mean of what it holds in each log, a unit normal each, shape (m, n, k) [Nm].
        remarks: joints whose torque does not hold the arm.
    """

    holds: Array
    columns: Array
    remarks: tuple[str, ...]

    @classmethod
    def of(cls, motion: PreparedLog, robot: Robot, predicted: Array, numbers: Array) -> Resting:
        """Of one log.

        Args:
            motion: the log, prepared.
            robot: as its file has it; a joint of which it states no dry friction is no witness.
            predicted: its torque along the motion, shape (m, n) [Nm].
            numbers: columns of the robot's numbers with unit priors, shape (m, n, k) [Nm].
        """
        holds = held_at_rest(robot)
        # a channel that never changes has no torque
        resting = rests(motion.row_known) & (np.ptp(motion.tau, axis=0) > 0.0)
        left = rms(motion.tau - predicted)
        spread = np.sqrt(np.mean(np.sum(numbers**2, axis=2), axis=0))
        held = left < BELIEVED * np.hypot(holds, spread)
        holds = np.where(resting & held, holds, np.inf)
        pairs = [(j, part) for j in np.flatnonzero(np.isfinite(holds)) for part in motion.parts]
        columns = np.zeros((len(motion.time), motion.n, len(pairs)))
        for k, (j, part) in enumerate(pairs):
            columns[part, j, k] = holds[j]
        otherwise = np.flatnonzero(resting & ~held) + 1
        return cls(holds, columns, tuple(HELD_OTHERWISE.format(joint=j) for j in otherwise))
