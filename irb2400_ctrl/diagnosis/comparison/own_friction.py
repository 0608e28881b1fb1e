"""What the torque of a friction is held against."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

TIMES = 5.0
"""times its own friction that the torque of a joint counts as at most: a fifth of an axis' friction
matters on one that bears weight, too"""
AGAINST = 0.9
"""share of the work of a torque that has one sign, from which on it is a friction, or lacks one"""


class OwnFriction:
    """Friction of each joint along a log, as its file states it."""

    def __init__(self, robot: Robot, motion: PreparedLog) -> None:
        known = np.where(robot.friction_known, robot.friction, 0.0)
        self.speed = motion.filtered_reading(motion.qd)
        self.rms = rms(known[:, 1] + known[:, 2] * np.abs(motion.qd))

    def counted(self, torque: Array, usual: Array) -> Array:
        """Rms torque of each joint that a torque is held against: all of it, or, if it acts against
        the motion, a few times the friction, shape (n,) [Nm].

        Args:
            torque: in question, shape (rows, n) [Nm].
            usual: rms torque of each joint, shape (n,) [Nm].
        """
        work = torque * self.speed
        against = np.abs(work.sum(axis=0)) > AGAINST * np.abs(work).sum(axis=0)
        return np.where(against & (self.rms > 0.0), np.minimum(usual, TIMES * self.rms), usual)
