"""When a timed path passes given places and way-points."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve


def passing_times(law: TimeLaw, s: Array) -> Array:
    """When the lengths s (k,) [m] along the joint path are passed [s], the mean speed between a
    grid point and s being that of both."""
    cell = np.clip(np.searchsorted(law.s, s, side="right") - 1, 0, len(law.s) - 2)
    gone = s - law.s[cell]
    speed = np.sqrt(law.x[cell]) + np.sqrt(np.maximum(law.on(s)[0], 0.0))
    step = np.where(gone > 0, 2 * gone / np.maximum(speed, 1e-12), 0.0)
    return np.asarray(np.minimum(law.time[cell] + step, law.time[cell + 1]))


def point_lengths(curve: TaskCurve, followed: Followed) -> Array:
    """Length along the joint path [m] at which each way-point of a tool path is passed (or the
    rounded corner nearest to it), shape (n,)."""
    numbers = np.arange(len(curve.path))
    ends = np.searchsorted(curve.origin, numbers, side="right").astype(float)
    # a way-point that was left out repeats the one before; the first is where the curve begins
    ends[0] = 0.0
    return np.asarray(np.interp(ends, followed.u, followed.joints.knots))
