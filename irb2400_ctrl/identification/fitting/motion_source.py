"""Speed and acceleration of a log: from its angles, or from the speed that it recorded."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from scipy.ndimage import gaussian_filter1d

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare

Source = Literal["angle", "speed"]

SMOOTHING_TIME = 0.020
"""[s] standard deviation of the Gaussian over the recorded speed"""


def motion_of(log: Log, source: Source) -> PreparedLog:
    """A log prepared for comparison.

    Args:
        source: "angle": q differentiated twice; "speed": the recorded qd smoothed, and
            differentiated once. Time stamps of a host jitter, and the second derivative of an angle
            feels that most. A log without speed has only the first.
    """
    motion = prepare(log, quiet=True)
    if source == "angle" or log.qd is None:
        return motion
    width = SMOOTHING_TIME / float(np.median(np.diff(log.time)))
    qd = gaussian_filter1d(log.qd, width, axis=0)
    qdd = np.gradient(qd, log.time, axis=0)
    return replace(
        motion,
        qd=_at(motion.time, log.time, qd),
        qdd=_at(motion.time, log.time, qdd),
    )


def _at(time: Array, known: Array, signal: Array) -> Array:
    return np.column_stack([np.interp(time, known, column) for column in signal.T])
