"""The motion of a log as a reference for the simulated arm."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.uniform import resample
from irb2400_ctrl.simulation.trajectory import Trajectory

CUTOFF_HZ = 8.0
"""commanded motions of an arm lie below it; printed digits and encoder steps above"""


def recorded_motion(log: Log) -> Trajectory:
    """The commanded motion of a log (the measured one if it has none), smoothed, with its derivatives.

    Zero-phase low-pass, then a cubic spline through the samples.
    """
    from scipy.interpolate import CubicSpline
    from scipy.signal import butter, sosfiltfilt

    uniform = resample(log)
    q = uniform.q if uniform.q_ref is None else uniform.q_ref
    q = np.asarray(sosfiltfilt(butter(3, CUTOFF_HZ, fs=uniform.rate, output="sos"), q, axis=0))
    time = uniform.time - uniform.time[0]
    spline = CubicSpline(time, q)
    return Trajectory(time, q, spline(time, 1), spline(time, 2))
