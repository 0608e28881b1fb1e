"""The inertia that scales joint-wise gains."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def typical_inertia(robot: Robot) -> NDArray[np.float64]:
    """Geometric mean between the extremes of 1 / (M^-1)_jj over the joint box, shape (n,) [kg m2].

    This is what a torque on one axis has to move while the others are free: with the wrist
    stretched, axes 4 and 6 turn against each other and each is a third as heavy as M_jj says. The
    gain error of an axis is then the same factor, up and down, at both ends of its range.
    """
    rng = np.random.default_rng(0)
    q = rng.uniform(robot.q_min, robot.q_max, (256, robot.n))
    if robot.n > 4:
        q[0, 4] = 0.0  # the lightest pose of the wrist, which chance may miss
    felt = 1.0 / np.einsum("kjj->kj", np.linalg.inv(Model(robot).mass_matrix(q)))
    return np.asarray(np.sqrt(felt.min(axis=0) * felt.max(axis=0)))
