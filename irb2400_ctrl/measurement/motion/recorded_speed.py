"""The speed that a log recorded, where its angles came at other instants than their stamps.

A host that polls a robot reads some samples twice and misses others, and a stamp off by dt is an
angle off by qd dt; the speed hardly changes in that time. A recorded speed may also be filtered, or
commanded, and then is calmer as well: it takes the place of differentiated angles only where rows
that repeat show that the robot was polled, and it says the same, neither scaled, shifted nor late.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from irb2400_ctrl.arrays import Array, Mask, rms
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
SHIFTED = 0.05
"""of it that the two may be apart all along, alike"""
MOVES = 0.01
"""[rad/s] rms of a joint that moves"""
TWICE = 0.01
"""share of the rows in motion that repeat the row before, from which a host has polled"""
DIGITS = 3.0
"""least differences of an angle that a joint must have moved by, not to be where it was"""
FEWEST = 50
"""rows away from gaps"""


def calmer_speed(
    log: Log, step: float, qd: Array, qdd: Array, valid: Mask
) -> tuple[Array, ...] | None:
    """qd, qdd, qddd, qdddd from the recorded speed, each (m, n); None where the log has none, or
    where the angles tell as much.

    Args:
        log: as recorded, on its time base.
        step: of the uniform grid [s].
        qd, qdd: from the angles on that grid, (m, n) [rad/s, rad/s2].
        valid: rows of the grid away from gaps, (m,).
    """
    if log.qd is None or not polled(log):
        return None
    on_grid = resample(replace(log, q=log.qd, qd=None, q_ref=None), 1.0 / step).q
    found = derivatives(smoothed(on_grid, step), step, 3)
    rows = valid.copy()
    rows[: derivative_margin(step)] = False
    rows[len(rows) - derivative_margin(step) :] = False
    if rows.sum() < FEWEST:
        return None
    moving = rms(qd[rows]) > MOVES
    resting = rms(found[0][rows][:, ~moving])
    if not moving.any() or (resting > 2.0 * MOVES).any():
        return None
    speed, acceleration = (one[:, moving] for one in found[:2])
    quick = [_quick(one, step)[rows] for one in (acceleration, qdd[:, moving])]
    rough = [np.std(one, axis=0) + 1e-12 for one in quick]
    if np.exp(np.mean(np.log(rough[0] / rough[1]))) > CALMER:
        return None
    pairs = zip(qd[rows][:, moving].T, speed[rows].T, acceleration[rows].T, strict=True)
    off = np.abs([_difference(*pair) for pair in pairs]) / (SCALED, LATE, SHIFTED, ELSE)
    same = (np.median(off, axis=0) < 1.0).all() and (off < 2.0).all()
    return found if same else None


def polled(log: Log) -> bool:
    """Whether a host has read samples twice: rows in which no angle is another one than in the row
    before, though a joint moves by several of its digits."""
    if log.qd is None:
        return False
    change = np.abs(np.diff(log.q, axis=0))
    digit = np.min(np.where(change > 0.0, change, np.inf), axis=0)
    passed = np.abs(log.qd[1:]) * np.diff(log.time)[:, None]
    moving = (passed > DIGITS * digit).any(axis=1)
    again = moving & (change == 0.0).all(axis=1)
    return bool(again.sum() > TWICE * max(int(moving.sum()), 1))


def _quick(acceleration: Array, step: float) -> Array:
    """What is quicker than the motion, shape (m, n) [rad/s2]."""
    mean = uniform_filter1d(acceleration, max(3, round(QUICK_TIME / step)), axis=0)
    return np.asarray(acceleration - mean)


def _difference(by_angle: Array, speed: Array, acceleration: Array) -> Array:
    """How the angles move beside a recorded speed: by_angle = (1 + scale) speed + lead
    acceleration + shift + rest; (scale, lead, shift and rms of the rest over the rms of by_angle)
    [-, s, -, -]."""
    columns = np.column_stack([speed, acceleration, np.ones(len(speed))])
    found = np.linalg.lstsq(columns, by_angle - speed, rcond=None)[0]
    left = by_angle - speed - columns @ found
    size = np.sqrt(np.mean(by_angle**2))
    return np.array([found[0], found[1], found[2] / size, np.sqrt(np.mean(left**2)) / size])
