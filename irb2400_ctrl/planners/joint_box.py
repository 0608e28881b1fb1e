"""What a single configuration must satisfy: inside the joint box, and light enough to be held."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def outside_box(model: Model, q: Array) -> str | None:
    """What of q (m, n) leaves the joint box, in words; None where nothing does."""
    robot = model.robot
    excess = np.maximum(robot.q_min - q, q - robot.q_max)
    if excess.max() > 1e-9:
        row, axis = np.unravel_index(int(np.argmax(excess)), excess.shape)
        low, high = np.degrees([robot.q_min[axis], robot.q_max[axis]])
        return (
            f"axis {axis + 1} at {np.degrees(q[row, axis]):.2f} deg, range {low:.0f} to "
            f"{high:.0f} deg"
        )
    if robot.coupling.difference_deg is not None:
        difference = np.degrees(q[:, 2] - q[:, 1])
        low, high = robot.coupling.difference_deg
        worst = int(np.argmax(np.maximum(low - difference, difference - high)))
        if not low - 1e-7 <= difference[worst] <= high + 1e-7:
            return f"q3 - q2 at {difference[worst]:.2f} deg, range {low:.0f} to {high:.0f} deg"
    return None


def left_in_box(robot: Robot, q: Array) -> Array:
    """How far the nearest end of a range is from configurations (..., n), negative outside [rad],
    shape (...)."""
    return np.asarray(np.minimum(q - robot.q_min, robot.q_max - q).min(axis=-1))


def inside_box(model: Model, name: str, q: Array) -> None:
    """Refuse a configuration (n,) outside the joint box, by the name it has in the request.

    Args:
        model: of the arm.
        name: for the message.
        q: [rad], shape (n,).

    Raises:
        InputError: outside, with the axis and its range.
    """
    problem = outside_box(model, q[None])
    if problem is not None:
        raise InputError(f"{name} is outside the joint box: {problem}")


def can_hold(model: Model, name: str, q: Array) -> None:
    """Refuse a configuration (n,) in which the torque limits cannot carry the arm.

    Args:
        model: of the arm.
        name: for the message.
        q: [rad], shape (n,).

    Raises:
        InfeasibleError: with the axis and what it needs.
    """
    needed = np.abs(model.gravity(q))
    limit = model.robot.tau_max
    if (needed > limit).any():
        axis = int(np.argmax(needed / limit))
        raise InfeasibleError(
            f"{name}: axis {axis + 1} cannot hold the arm: needs {needed[axis]:,.0f} of "
            f"{limit[axis]:,.0f} Nm"
        )
