"""Random joint paths for tests and benchmarks of the planner."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from irb2400_ctrl import load_robot
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.robot import Robot

Array = npt.NDArray[np.float64]


def random_way_points(
    seed: int, points: int = 6, robot: Robot | None = None
) -> tuple[Array, Array]:
    """Normalised chord length and way-points in the joint box of an arm (the paper's), shapes
    (points,), (points, 6)."""
    robot = robot or load_robot("irb2400")
    rng = np.random.default_rng(seed)
    q = rng.uniform(0.8 * robot.q_min, 0.8 * robot.q_max, (points, 6))
    q[:, [3, 5]] = rng.uniform(-2, 2, (points, 2))
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1))])
    return s / s[-1], q


def random_path(seed: int, points: int = 6) -> JointPath:
    """A cubic spline through them."""
    return JointPath.through(*random_way_points(seed, points))
