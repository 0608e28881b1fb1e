"""The curve of a finding: measured torque over a signal of its joint, beside the law."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.finding import Curve
from irb2400_ctrl.measurement.prepared_log import PreparedLog

UNITS = {"q": "rad", "qd": "rad/s", "qdd": "rad/s2", "load": "Nm", "time": "s"}
FEWEST = 3
"""samples that make a bin"""
BINS = 40
"""of a curve, at most; of few samples so many that twice the fewest come to a bin"""


def binned_curve(
    motion: PreparedLog,
    load: Array,
    joint: int,
    signal: str,
    law: Array,
    residual: Array,
    *,
    period: float | None = None,
    turned: bool = False,
) -> Curve:
    """Binned torque over a signal of the joint (zero-based), folded to one period if it has one;
    with a 95 % band.

    `turned`: the torque of backward motion is turned over, so that friction of both directions lies
    on one curve.

    Args:
        motion: the log, prepared.
        load: torque of the rigid arm [Nm], shape (rows, n).
        joint: counted from 0.
        signal: that the law depends on.
        law: what is said of it [Nm], shape (rows,).
        residual: what is left [Nm], shape (rows,).
        period: of the signal, in its unit.
    """
    if turned:
        sign = np.sign(motion.at_rows(motion.qd[:, joint]))
        law = sign * law
        residual = sign * residual
    rows = motion.row_known[:, joint]
    x = _abscissa(motion, load, joint, signal, period)[rows]
    line = law[rows]
    seen = (law + residual)[rows]
    bins = int(np.clip(len(x) // (2 * FEWEST), 1, BINS))
    edges = np.linspace(x.min(), x.max() + 1e-12, bins + 1) if len(x) else np.zeros(1)
    place = np.clip(np.digitize(x, edges) - 1, 0, bins - 1)
    inside = [place == k for k in range(bins)]
    used = [bin_ for bin_ in inside if bin_.sum() >= FEWEST]
    middle = np.array([x[bin_].mean() for bin_ in used])
    mean = np.array([seen[bin_].mean() for bin_ in used])
    error = np.array([2.0 * seen[bin_].std() / np.sqrt(bin_.sum()) for bin_ in used])
    expected = np.array([line[bin_].mean() for bin_ in used])
    for array in (middle, mean, expected):
        array.setflags(write=False)
    unit = UNITS[signal] + ("" if period is None else ", within one period")
    return Curve(
        joint + 1, signal, unit, middle, mean, mean - error, mean + error, expected, turned
    )


def _abscissa(
    motion: PreparedLog, load: Array, joint: int, signal: str, period: float | None
) -> Array:
    """The signal at the rows of the log, within one period if it has one."""
    sources = {"q": motion.q, "qd": motion.qd, "qdd": motion.qdd, "load": load}
    x = motion.row_time if signal == "time" else motion.at_rows(sources[signal][:, joint])
    return x if period is None else np.mod(x, period)
