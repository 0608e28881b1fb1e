"""A log of one joint that runs forth and back at constant speeds, made from the law itself."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.excitation.friction_runs import there_and_back
from irb2400_ctrl.model.friction import FrictionLaw

LAW = FrictionLaw(30.0, 20.0, 9.0, 0.008)
"""F_s, F_c, F_v, omega_st"""
OFFSET = 4.0


def log_of(
    speeds: Sequence[float],
    joint: int = 2,
    law: FrictionLaw = LAW,
    noise: float = 0.3,
    jerks: Callable[[np.ndarray], np.ndarray] | None = None,
) -> irb.Log:
    """Six joints of which one moves, under gravity 100 cos q.

    Args:
        jerks: what is added to the angle, of time, as by a drive that sticks and slips.
    """
    rng = np.random.default_rng(5)
    states = np.concatenate([there_and_back(speed) for speed in speeds])
    m = len(states)
    time = np.arange(m) / 250.0
    q = np.tile([0.1, -0.2, 0.3, 0.4, 0.5, 0.6], (m, 1))
    angle = states[:, 0] + (0.0 if jerks is None else jerks(time))
    q[:, joint - 1] += angle
    tau = np.zeros((m, 6))
    gravity = 100.0 * np.cos(q[:, joint - 1])
    tau[:, joint - 1] = gravity + OFFSET + law.torque(states[:, 1])
    tau += noise * rng.standard_normal((m, 6))
    q += 2e-6 * rng.standard_normal((m, 6))
    return irb.Log(time, q, tau, name="runs")
