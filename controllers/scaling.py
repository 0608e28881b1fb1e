"""What each axis weighs on its own: the inertia that scales joint-wise gains."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def typical_inertia(robot: Robot, poses: int = 64) -> NDArray[np.float64]:
    """Geometric mean of M_jj(q) between its extremes over the joint box, shape (n,) [kg m2].

    The gain error of an axis is then the same factor, up and down, at both ends of its inertia range.
    """
    rng = np.random.default_rng(0)
    q = rng.uniform(robot.q_min, robot.q_max, (poses, robot.n))
    diagonal = np.einsum("kjj->kj", Model(robot).mass_matrix(q))
    return np.asarray(np.sqrt(diagonal.min(axis=0) * diagonal.max(axis=0)))
