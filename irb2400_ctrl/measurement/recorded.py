"""The motion of a log, to be followed again."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.uniform import resample
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.typed import typed

CUTOFF_HZ = 8.0
"""commanded motions of an arm lie below it; printed digits and encoder steps above"""
SETTLED_S = 1.0
"""by which the record is continued at both ends, so that the filter has settled"""
SAME_RAD = 1e-9
"""angles that differ by less are one"""
STOP_RAD_S = 0.01
"""a command that stands still from faster than this on was cut off, not stopped"""


@typed
def recorded_motion(log: Log) -> Trajectory:
    """The commanded motion of a log (the measured one if it has none), smoothed, with its
    derivatives.

    Zero-phase low-pass, then a cubic spline through the samples. It ends where the command was cut
    off.
    """
    from scipy.interpolate import CubicSpline
    from scipy.signal import butter, sosfiltfilt

    uniform = resample(log)
    q = uniform.q if uniform.q_ref is None else uniform.q_ref
    q = q[: _end(q, uniform.rate)]
    padding = min(round(SETTLED_S * uniform.rate), len(q) - 1)
    q = np.asarray(
        sosfiltfilt(butter(3, CUTOFF_HZ, fs=uniform.rate, output="sos"), q, axis=0, padlen=padding)
    )
    time = uniform.time[: len(q)] - uniform.time[0]
    spline = CubicSpline(time, q)
    return Trajectory(time, q, spline(time, 1), spline(time, 2))


def _end(q: Array, rate: float) -> int:
    """Number of samples before the command was cut off in full motion, where recorders hold the
    last value."""
    held = np.argmax(np.abs(q[::-1] - q[-1]) > SAME_RAD, axis=0)
    # the step into the held value may be a part of one
    last = len(q) - held - 1
    speed = [abs(q[k, j] - q[k - 1, j]) * rate for j, k in enumerate(last)]
    cut = (held > 1) & (np.array(speed) > STOP_RAD_S)
    return int(last[cut].min(initial=len(q)))
