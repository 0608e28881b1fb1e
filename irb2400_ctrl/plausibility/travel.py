"""Angles that travel many times a joint's range: the motor's, not the joint's."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility.problem import LogProblem, named
from irb2400_ctrl.robot import Robot

TIMES = 8.0
"""travel over the range of the robot file from which an angle is not the joint's"""


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
        f"the angle of {named(joints)} looks like the motor's: joint {j + 1} travels "
        f"{np.degrees(travel[j]):.0f} deg, its range is {np.degrees(room[j]):.0f} deg; give the "
        "gear ratio in a column map" + (f" (the robot file states {stated})" if gears else ""),
        {"gear_ratios": {str(k): ratio for k, ratio in gears.items()}} if gears else {},
        tuple(joints),
    )
