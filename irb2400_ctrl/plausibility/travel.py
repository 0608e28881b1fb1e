"""Angles that travel many times a joint's range, or move much faster than it can: the motor's, not
the joint's, or by a clock that runs too fast."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility.problem import LogProblem, named
from irb2400_ctrl.robot import Robot

TIMES = 8.0
"""travel over the range of the robot file from which an angle is not the joint's"""
FASTER = 2.0
"""speed over the limit of the robot file from which a joint has not moved so"""
OVER_TIME = 0.04
"""[s] over which a speed is taken"""
MOMENT = 0.99
"""share of the samples that is slower: a jump alone is no speed"""


def travel_problem(robot: Robot, log: Log) -> LogProblem | None:
    """Joints whose angle goes through many times the range that the robot file states.

    A ratio cannot be read from the motion alone (a fixed shift hides in the zero of the motor), so
    the one of the robot file is said where it states one.
    """
    travel = np.ptp(log.q, axis=0)
    room = robot.q_max - robot.q_min
    far = np.flatnonzero(travel > TIMES * room)
    if not len(far):
        return None
    j = int(far[0])
    joints = [int(k) + 1 for k in far]
    gears = {
        k: transmission.gear_ratio
        for k in joints
        if (transmission := robot.joints[k - 1].transmission) is not None
        and transmission.gear_ratio is not None
    }
    stated = ", ".join(f"{ratio:g}" for ratio in gears.values())
    return LogProblem(
        "angle_scale",
        f"the angle of {named(joints)} looks like the motor's: {travelled(robot, log, j)}; give "
        "the gear ratio in a column map" + (f" (the robot file states {stated})" if gears else ""),
        {"gear_ratios": {str(k): ratio for k, ratio in gears.items()}} if gears else {},
        tuple(joints),
    )


def travelled(robot: Robot, log: Log, j: int) -> str:
    """How far a joint goes, and how far it can.

    Args:
        robot: with the range; log: with the angle; j: the joint, from 0.
    """
    travel, room = np.degrees([np.ptp(log.q[:, j]), robot.q_max[j] - robot.q_min[j]])
    return f"joint {j + 1} travels {travel:.0f} deg, its range is {room:.0f} deg"


def fastest(robot: Robot, log: Log) -> Array:
    """Speed of each joint over the limit of the robot file, 0 where it states none, shape (n,)."""
    width = max(1, round(OVER_TIME * log.rate))
    if len(log.time) <= width:
        return np.zeros(log.n)
    passed = (log.time[width:] - log.time[:-width])[:, None]
    speed = np.quantile(np.abs(log.q[width:] - log.q[:-width]) / passed, MOMENT, axis=0)
    limits = [joint.limits.speed_deg_s for joint in robot.joints]
    return np.asarray(speed / np.radians([np.inf if v is None else v for v in limits]))


def haste_problem(robot: Robot, log: Log) -> LogProblem | None:
    """Joints that move at much more than the speed limit that the robot file states.

    A log that is too short to be held against the model by such a clock is seen by this alone.
    """
    ratio = fastest(robot, log)
    fast = np.flatnonzero(ratio > FASTER)
    if not len(fast):
        return None
    j = int(np.argmax(ratio))
    limit = robot.joints[j].limits.speed_deg_s or 0.0
    joints = [int(k) + 1 for k in fast]
    return LogProblem(
        "too_fast",
        f"{named(joints)} {'moves' if len(joints) == 1 else 'move'} faster than the robot can: "
        f"joint {j + 1} at {ratio[j] * limit:.0f} deg/s, {ratio[j]:.1f} times the limit of the "
        "robot file: a clock that runs too fast (check the rate, or the unit of time), or angles "
        "of another unit",
        {"over_limit": float(f"{ratio[j]:.3g}")},
        tuple(joints),
    )
