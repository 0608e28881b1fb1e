"""Whether a time step can follow the springs of elastic joints."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.elasticity import elastic_data, elastic_joints, twist
from irb2400_ctrl.robot import Robot

__all__ = ["check_step", "elastic_data", "elastic_joints", "twist"]


def check_step(robot: Robot, step: float) -> None:
    """The leapfrog is stable and accurate to a few per cent while omega h stays below 0.6.

    omega^2 = k (1/J + 1/M) is bounded from below by k/J, which is what can be checked without a
    pose; a spring that stiffens has the k of the largest torque of its joint.
    """
    for j, (slack, damping, inertia, _, stiffening) in zip(
        elastic_joints(robot), elastic_data(robot), strict=True
    ):
        most = robot.joints[j].limits.torque_Nm or 0.0
        stiffness = np.hypot(slack, stiffening * most)
        if not inertia > 0:
            raise InputError(
                f"joint {j + 1} is elastic and its rotor inertia is {inertia} kg m2; expected more "
                "than 0"
            )
        fast = max(np.sqrt(stiffness / inertia), damping / inertia) * step
        if fast > 0.6:
            raise InputError(
                f"joint {j + 1}: motor on its spring turns {fast:.1f} rad per step of "
                f"{1e3 * step:g} ms; "
                f"expected at most 0.6; use {int(np.ceil(fast / 0.6))} times as many substeps"
            )
