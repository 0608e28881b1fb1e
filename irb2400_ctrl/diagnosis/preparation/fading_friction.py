"""How static friction fades with speed: of Stribeck's curve a file states one speed, and one of
several laws is taken for it.

Gauss' exp(-x^2) of eq. 54, Tustin's exp(-x) and Hess and Soom's 1 / (1 + x^2), x = |qd| / v_s,
agree near rest and are far from each other at some times v_s, where friction is measured best: left
out of the base, a further power of the speed would take its place.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

SPEED = 0.3
"""share by which v_s may be another, one standard deviation"""
LAW = 0.5
"""of the way to each of the other laws, one standard deviation"""


def fading_friction(robot: Robot, motion: PreparedLog) -> Array:
    """Columns (F_s - F_c) sgn(qd_j) times the change of exp(-x^2) by `SPEED` and `LAW`, shape (m,
    n, 3 n), joint by joint [Nm]; zero where the file states no static friction."""
    n = motion.n
    columns = np.zeros((len(motion.time), n, n, 3))
    for j, (static, coulomb, _, stribeck) in enumerate(robot.friction):
        if static > coulomb and stribeck > 0.0:
            x = np.abs(motion.qd[:, j]) / stribeck
            gauss = np.exp(-(x**2))
            others = [SPEED * 2.0 * x**2 * gauss]
            others += [LAW * (law - gauss) for law in (np.exp(-x), 1.0 / (1.0 + x**2))]
            by = (static - coulomb) * np.sign(motion.qd[:, j])
            columns[:, j, j] = by[:, None] * np.stack(others, axis=1)
    return columns.reshape(len(motion.time), n, -1)
