"""Joint moves (`joint_move`, ruckig's boxes scaled to the torque) against the certified straight
line between the same angles: durations, and what the limit of the jerk costs.

    python benchmarks/joint_moves.py [count] [seed]

Both ends are drawn over the middle half of the joint box, rest to rest. The line is timed three
times: torque may jump; the move's own limits of jerk; the torque rate that plans have by default.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import joint_move
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path


def durations(seed: int) -> tuple[float, float, float, float]:
    """Of the move, and of the line in the three timings [s]."""
    robot = irb.load_robot("irb2400")
    middle = (robot.q_min + robot.q_max) / 2
    half = (robot.q_max - robot.q_min) / 2
    ends = middle + half * np.random.default_rng(seed).uniform(-0.5, 0.5, size=(2, robot.n))
    move = joint_move(Model(robot), *ends)
    dynamics = path_dynamics(robot)
    way = float(np.linalg.norm(ends[1] - ends[0]))
    line = JointPath.straight(np.linspace(0.0, way, 41), np.linspace(ends[0], ends[1], 41))
    limits = MotionLimits.of(robot)
    jumping = time_joint_path(dynamics, line, limits)[0]
    jerk = time_rate_limited(dynamics, line, replace(limits, jerk=move.qddd_max))
    rate = Sampling(250.0, "cubic").torque_rate * robot.tau_max
    smooth = time_rate_limited(dynamics, line, replace(limits, torque_rate=rate))
    return move.duration, jumping.duration, jerk.duration, smooth.duration


def main(count: int = 20, seed: int = 0) -> None:
    """Print every draw, then the ratios."""
    found = np.array([durations(seed + k) for k in range(count)])
    print("       move    jumping  same jerk  default rate  [s]")
    for row in found:
        print("  " + " ".join(f"{value:10.3f}" for value in row))
    for name, column in (("jumping", 1), ("same jerk", 2), ("default rate", 3)):
        ratio = found[:, 0] / found[:, column]
        print(
            f"move / line, {name}: median {np.median(ratio):.3f}, "
            f"{ratio.min():.3f} to {ratio.max():.3f}"
        )


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:]))
