"""When the ratio of two columns is one factor, and not lost rows, rounding or coarse sampling."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.log_facts import digit
from irb2400_ctrl.plausibility.columns.runs import stretches

OVER = 0.04
"""[s] of a difference quotient"""
REST = 0.2
"""of a joint's fast speed (95 % are slower), below which it does not count, and"""
SLOW = 0.5
"""of it, below which a row is slow"""
ENOUGH = 20
"""rows each, slow and fast, that are compared"""
APART = 0.5
"""of the factor (both as logarithms) by which slow and fast rows may differ"""
COARSE = 5.0
"""digits of a speed beside which zero is no rounding"""
STEEP = 0.95
"""sine of half the phase between two samples, that is looked at at most"""


def quotients(log: Log) -> tuple[Array, int]:
    """Speeds as difference quotients of the angles, shape (m - w, n) [rad/s], and the samples w
    that each reaches over: quantised angles make noisy differences of neighbours."""
    w = max(1, round(OVER * log.rate))
    return (log.q[w:] - log.q[:-w]) / (log.time[w:] - log.time[:-w])[:, None], w


def filled(qd: Array, most: int) -> Array:
    """Speeds whose lost rows, single zeros in the middle of motion, are interpolated.

    Args:
        qd: recorded speed, shape (m, n).
        most: rows that may be lost in sequence.
    """
    found = np.array(qd)
    rows = np.arange(len(qd))
    least = COARSE * digit(qd)
    for j in range(qd.shape[1]):
        zero = qd[:, j] == 0.0
        lost = np.zeros(len(qd), dtype=bool)
        # neighbours in `stretches` are pairs: a pair of a zero and what stands before it
        for start, stop in stretches(zero[1:], 2):
            inside = stop < len(qd) and not zero[start] and stop - start - 1 <= most
            ends = qd[[start, min(stop, len(qd) - 1)], j]
            if inside and np.abs(ends).min() > least[j] and ends[0] * ends[1] > 0.0:
                lost[start + 1 : stop] = True
        if lost.any():
            found[lost, j] = np.interp(rows[lost], rows[~lost], qd[~lost, j])
    return found


def trapezoid_loss(derived: Array, width: int) -> Array:
    """How much smaller a speed that is averaged by trapezoids is than its mean, shape (n,).

    Of a sine with the phase 2 x from one sample to the next it is tan(x) / x; x is that of the
    difference quotients, which differ by 2 sin(width x) of their size.

    Args:
        derived: difference quotients, shape (m, n); width: samples that each reaches over.
    """
    size = np.maximum(np.linalg.norm(derived, axis=0), 1e-12)
    half = np.linalg.norm(derived[width:] - derived[:-width], axis=0) / size / 2.0
    x = np.maximum(np.arcsin(np.minimum(half, STEEP)) / width, 1e-6)
    return np.asarray(np.tan(x) / x)


def one_factor(here: Array, there: Array, ratio: float) -> bool:
    """Whether slow rows show the factor that fast ones show.

    A truncation takes more of slow speeds, a limit more of fast ones. Where there are rows of one
    kind only nothing speaks against a factor.

    Args:
        here, there: two columns that go together, shapes (m,).
        ratio: of the first over the second, all rows together.
    """
    # by the mean of both: of rows that noise makes large in one column the ratio would be large
    level = 0.5 * (here + ratio * there)
    fast = float(np.quantile(np.abs(level), 0.95))
    counts = np.abs(level) > REST * fast
    slow = np.abs(level) < SLOW * fast
    logs = []
    for rows in (counts & slow, counts & ~slow):
        if rows.sum() < ENOUGH:
            return True
        sign = np.sign(level[rows])
        found = float(sign @ here[rows]) / max(float(sign @ there[rows]), 1e-12)
        logs.append(float(np.log(max(found, 1e-12))))
    return abs(logs[0] - logs[1]) < APART * abs(float(np.log(ratio)))
