"""Samples at which dry friction may be anything: a joint rests, rocks, or sticks and slips."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.ndimage import uniform_filter1d

from irb2400_ctrl.arrays import Array, Mask, true_stretches
from irb2400_ctrl.measurement.uniform import HALF_WINDOW, widened

STILL_SPEED = 0.02
"""[rad/s] below this for longer than `STILL_TIME` dry friction is undetermined"""
STILL_TIME = 0.060
"""[s]"""
STICKING_SPEED = 0.03
"""[rad/s] below this a joint may stick, whether or not it turns"""
STICKING_TIME = 0.12
"""[s] how long before and after that its torque is not predictable"""
SLIPPING_SPEED = 0.1
"""[rad/s] below this a joint may stick and slip in turns"""
SLIPPING = 7.0
"""scatter of the torque from sample to sample, over that of the calm part of the log, above which
it does"""
CALM = 0.1
"""share of a log that is taken as calm: a slow joint may slip nearly all the time"""
SLIPPING_TIME = 0.5
"""[s] for at least so long: a reversal is shorter"""


def undetermined(tau: Array, qd: Array, step: float, instrumented: bool) -> Mask:
    """Samples of joints whose dry friction may be anything, shape (m, n).

    Args:
        tau, qd: of the log; step: between its samples [s].
        instrumented: whether the speed is the commanded one's.
    """
    still = _standstill(qd, step) | _stick_slip(tau, qd, step)
    return still if instrumented else still | _rocking(qd, step)


def slow(speed: Array, step: float) -> Mask:
    """Samples about the turns and rests of whatever turns at a speed, shape of the speed.

    Args:
        speed: [rad/s], samples along the first axis; step: between them [s].
    """
    return widened(turning(speed), round(STICKING_TIME / step))


def turning(speed: Array) -> Mask:
    """Samples at which whatever turns at a speed [rad/s] nearly stops, or before it turns back;
    samples along the first axis, shape of the speed."""
    found = np.abs(speed) < STICKING_SPEED
    found[:-1] |= np.diff(np.sign(speed), axis=0) != 0.0
    return found


def sticking(still: Mask, qd: Array, step: float) -> Mask:
    """What is still, and where a joint sticks while it should creep: smoothing of measured angles
    reaches that far, shape (m, n).

    Args:
        still: of `undetermined`; qd: [rad/s]; step: between samples [s].
    """
    return widened(still | (np.abs(qd) < STICKING_SPEED), round(STICKING_TIME / step))


def _standstill(qd: Array, step: float) -> Mask:
    """Samples in stretches of at least STILL_TIME with a speed below STILL_SPEED, per joint."""
    return _lasting(np.abs(qd) < STILL_SPEED, round(STILL_TIME / step))


def _rocking(qd: Array, step: float) -> Mask:
    """Samples between two turns of a joint that are nearer than the smoothing of its angles tells
    apart: when its dry friction turned over is not known, shape (m, n)."""
    found = np.zeros(qd.shape, dtype=np.bool_)
    for j in range(qd.shape[1]):
        turns = np.flatnonzero(np.diff(qd[:, j] > 0.0))
        for first, last in pairwise(turns):
            if last - first <= round(2 * HALF_WINDOW / step):
                found[first : last + 2, j] = True
    return found


def _lasting(found: Mask, least: int) -> Mask:
    """Only stretches of at least so many samples, per joint."""
    kept = np.zeros_like(found)
    for j in range(found.shape[1]):
        for start, stop in true_stretches(found[:, j]):
            if stop - start >= max(1, least):
                kept[start:stop, j] = True
    return kept


def _stick_slip(tau: Array, qd: Array, step: float) -> Mask:
    """Samples of slow joints whose torque jumps from sample to sample far more than elsewhere: they
    stick and slip in turns, faster than the log resolves, shape (m, n)."""
    bend = np.zeros_like(tau)
    bend[1:-1] = np.diff(tau, 2, axis=0)
    width = max(3, round(STICKING_TIME / step))
    power = uniform_filter1d(bend**2, width, axis=0, mode="nearest")
    # a running sum of squares may end below zero by its rounding
    scatter = np.sqrt(np.maximum(power, 0.0))
    calm = np.quantile(scatter, CALM, axis=0)
    found = (scatter > SLIPPING * calm) & (np.abs(qd) < SLIPPING_SPEED)
    found = _lasting(found, round(SLIPPING_TIME / step))
    return widened(found, width)
