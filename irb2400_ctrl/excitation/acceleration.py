"""Accelerations that a motion keeps: those of the robot file, assumed ones where it states none.

The torque limits alone do not bound them: a file knows the inertia of the links, and what a motor
of a light wrist turns is mostly its own rotor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.robot import Robot

ASSUMED_TIME = 0.1
"""[s] from rest to the speed limit where the file states no acceleration: an assumption"""


@dataclass(frozen=True)
class AccelerationLimits:
    """Of all joints.

    Args:
        values: [rad/s2], shape (n,).
        assumed: joints of which the file states none, from 1.
    """

    values: Array
    assumed: tuple[int, ...]

    @classmethod
    def of(cls, robot: Robot) -> AccelerationLimits:
        """Those that a motion of the robot keeps."""
        stated = [joint.limits.acceleration_deg_s2 for joint in robot.joints]
        values = [
            float(speed) / ASSUMED_TIME if limit is None else float(np.radians(limit))
            for limit, speed in zip(stated, robot.qd_max, strict=True)
        ]
        missing = [j + 1 for j, limit in enumerate(stated) if limit is None]
        return cls(np.array(values), tuple(missing))

    def ratio(self, qdd: Array) -> float:
        """Largest share of the limits; qdd [rad/s2], shape (m, n)."""
        return float((np.abs(qdd) / self.values).max())

    def remark(self) -> str:
        """What is assumed, in words; empty where the file states all."""
        if not self.assumed:
            return ""
        values = ", ".join(f"{np.degrees(self.values[j - 1]):.0f}" for j in self.assumed)
        every = len(self.assumed) == len(self.values)
        joints = "every joint" if every else "joint " + ", ".join(map(str, self.assumed))
        return (
            f"assumed as acceleration limit of {joints}: {values} deg/s2 (speed limit in "
            f"{ASSUMED_TIME:g} s); the robot file states no acceleration_deg_s2"
        )
