"""Random states inside the joint box and the speed limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class States:
    """n states of the arm, each array (n, 6)."""

    q: Array
    qd: Array
    qdd: Array


def random_states(robot: irb.Robot, count: int, seed: int = 0) -> States:
    rng = np.random.default_rng(seed)
    shape = (count, robot.n)
    return States(
        q=rng.uniform(robot.q_min, robot.q_max, shape),
        qd=rng.uniform(-robot.qd_max, robot.qd_max, shape),
        qdd=rng.uniform(-20.0, 20.0, shape),
    )
