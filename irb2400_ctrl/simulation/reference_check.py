"""Whether a reference can be meant for this arm, before anything is simulated."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

FAR_RAD = 0.5
"""farther outside the joint box than any arm gets [rad]; nearer is simulated, and said"""
FAR_SPEED = 3.0
"""the same for speeds, as a multiple of the limits"""
BETWEEN_SAMPLES = 0.005
"""of the speed limit, by which a motion that comes to it between two samples of 4 ms is read above
it; 0.0034 for a move of 32 ms"""
OTHER_TORQUES = 0.7
"""of the torques of half of the joints, which are another arm's; 20 kg more at the flange of an IRB
2400 change them by 0.3 to 0.6, another arm by 0.9 and more"""


def check_reference(robot: Robot, motion: Trajectory) -> None:
    """Refuses a motion that no arm of this kind makes.

    Raises:
        InputError: angles or speeds far beyond the limits of the robot file.
    """
    over = _beyond(robot, motion.q)
    if over.max() > FAR_RAD:
        axis = int(np.argmax(over))
        found = f"axis {axis + 1} reaches {np.degrees(_largest(motion.q[:, axis])):.4g} deg"
        box = np.degrees([robot.q_min[axis], robot.q_max[axis]])
        hint = "check that the file is this arm's (--robot)"
        # another arm's angles would fit as degrees, too, being small numbers of radians
        fits = _beyond(robot, np.radians(motion.q)).max() <= FAR_RAD
        if fits and np.abs(motion.q).max() > 2 * np.pi:
            hint = "the numbers fit if they are degrees: name the columns q1_deg, ..."
        raise InputError(
            f"trajectory: found {found}; expected {box[0]:.4g} to {box[1]:.4g} deg ({robot.name}); "
            f"{hint}"
        )
    share = np.abs(motion.qd).max(axis=0) / robot.qd_bound
    if share.max() > FAR_SPEED:
        axis = int(np.argmax(share))
        found = np.degrees(np.abs(motion.qd[:, axis]).max())
        raise InputError(
            f"trajectory: found {found:.4g} deg/s on axis {axis + 1}; expected at most "
            f"{np.degrees(robot.qd_bound[axis]):.4g} deg/s ({robot.name}); check the unit of time, "
            "or plan the motion for this arm"
        )


def planned_for_another(robot: Robot, motion: Trajectory) -> str | None:
    """What to say of a motion that came with torques which are not this robot's."""
    if motion.tau is None or motion.tau.shape[1] != robot.n:
        return None
    own = Model(robot).inverse_dynamics(motion.q, motion.qd, motion.qdd)
    size = np.maximum(rms(own), rms(motion.tau))
    off = float(np.median(rms(own - motion.tau) / np.maximum(size, 1e-9)))
    if off < OTHER_TORQUES:
        return None
    return (
        f"the torques planned with this motion are not those of {robot.name} (half of its joints "
        f"are off by {100 * off:.0f} % and more): was it planned for another robot (--robot)?"
    )


def outside_box(robot: Robot, q: Array) -> list[int]:
    """Axes (from 1) whose angles leave the joint box."""
    return [int(j) + 1 for j in np.flatnonzero(_beyond(robot, q) > 1e-9)]


def too_fast(robot: Robot, qd: Array) -> list[int]:
    """Axes (from 1) that are faster than their limits, by more than what reading a motion between
    its samples adds."""
    over = np.abs(qd).max(axis=0) > robot.qd_bound * (1 + BETWEEN_SAMPLES)
    return [int(j) + 1 for j in np.flatnonzero(over)]


def _beyond(robot: Robot, q: Array) -> Array:
    """By how much each axis leaves the joint box at most [rad], shape (n,)."""
    over = np.maximum(q - robot.q_max, robot.q_min - q)
    return np.asarray(over.max(axis=0))


def _largest(values: Array) -> float:
    return float(values[np.argmax(np.abs(values))])
