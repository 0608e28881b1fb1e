"""The speed that a log recorded, where its angles came at other instants than their stamps.

A host that polls a robot reads some samples twice and misses others, and a stamp off by dt is an
angle off by qd dt; the speed hardly changes in that time. A recorded speed may also be filtered, or
commanded: it takes the place of differentiated angles only where it is much calmer and says the
same, neither scaled nor late.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.uniform import derivative_margin, derivatives, resample, smoothed

QUICK_TIME = 0.1
"""[s] what of an acceleration is quicker than its mean over so long is held against each other"""
CALMER = 0.5
"""rms of that over the same from the angles, in the geometric mean of the joints that move, below
which the recorded speed is taken"""
SCALED = 0.05
"""by which a speed that is the same may be off in the median of the joints, and twice that on one:
a host that misses samples counts too little time"""
LATE = 0.01
"""[s] by which it may come late, alike"""
ELSE = 0.2
"""of the speed of the angles that it may leave, alike: their noise, but not a dead channel"""
MOVES = 0.01
"""[rad/s] rms of a joint that moves"""


def calmer_speed(log: Log, step: float, qd: Array, qdd: Array) -> tuple[Array, ...] | None:
    """qd, qdd, qddd, qdddd from the recorded speed, each (m, n); None where the log has none, or
    where the angles tell as much.

    Args:
        log: as recorded, on its time base.
        step: of the uniform grid [s].
        qd, qdd: from the angles on that grid, (m, n) [rad/s, rad/s2].
    """
    if log.qd is None:
        return None
    on_grid = resample(replace(log, q=log.qd, qd=None, q_ref=None), 1.0 / step).q
    found = derivatives(smoothed(on_grid, step), step, 3)
    inside = slice(derivative_margin(step), len(qd) - derivative_margin(step))
    moving = np.sqrt(np.mean(qd[inside] ** 2, axis=0)) > MOVES
    if not moving.any():
        return None
    speed, acceleration = (one[inside][:, moving] for one in found[:2])
    quick = [_quick(one, step) for one in (acceleration, qdd[inside][:, moving])]
    if np.exp(np.mean(np.log(quick[0] / quick[1]))) > CALMER:
        return None
    pairs = zip(qd[inside][:, moving].T, speed.T, acceleration.T, strict=True)
    off = np.abs([_difference(*pair) for pair in pairs]) / (SCALED, LATE, ELSE)
    same = (np.median(off, axis=0) < 1.0).all() and (off < 2.0).all()
    return found if same else None


def _quick(acceleration: Array, step: float) -> Array:
    """Rms of what is quicker than the motion, per joint [rad/s2]."""
    mean = uniform_filter1d(acceleration, max(3, round(QUICK_TIME / step)), axis=0)
    return np.asarray(np.std(acceleration - mean, axis=0) + 1e-12)


def _difference(by_angle: Array, speed: Array, acceleration: Array) -> Array:
    """How the angles move beside a recorded speed: by_angle = (1 + scale) speed + lead
    acceleration + rest, (scale, lead, rms of the rest over that of by_angle) [-, s, -]."""
    columns = np.column_stack([speed, acceleration, np.ones(len(speed))])
    found = np.linalg.lstsq(columns, by_angle - speed, rcond=None)[0]
    left = by_angle - speed - columns @ found
    rest = np.sqrt(np.mean(left**2) / np.mean(by_angle**2))
    return np.array([found[0], found[1], rest])
