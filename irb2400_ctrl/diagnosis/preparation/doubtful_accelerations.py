"""Accelerations that the noise of the angles makes: part of the motion that no arm has felt.

Errors in variables. Where a share of a measured acceleration is noise, the torque that belongs to
it, M(:, j) times that share, is missing from the log; an effect that smooths the load (a spring in
the transmission) would give it back. What may be overstated is known from the log itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import convolve1d
from scipy.signal import firwin

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.instants.time_base import with_time_base
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.plausibility.cost_of_noise import acceleration_noise

BANDS = ((2.5, 5.0), (5.0, 10.0))
"""[Hz] in which the noise's share of an acceleration is taken as one number"""
HALF_LENGTH = 0.5
"""[s] of the filters that part the bands"""
LEAST = 0.01
"""share of the noise below which an acceleration is taken as it is"""


def doubtful_accelerations(model: Model, logs: Sequence[Log], motion: PreparedLog) -> Array:
    """Columns M(:, j) times the acceleration of joint j in a band, and times its rate, in units of
    the share that is noise, shape (m, n, columns) [Nm].

    Nothing where the motion is the commanded one: it carries no noise of the angles.

    Args:
        model: the arm.
        logs: as recorded.
        motion: the same, prepared.
    """
    if motion.instrumented:
        return np.zeros((len(motion.time), motion.n, 0))
    M = np.asarray(model.mass_matrix(motion.q))
    drawn = [acceleration_noise(with_time_base(log), 1.0 / motion.step)[0] for log in logs]
    columns = []
    for band in BANDS:
        middle = 2.0 * np.pi * float(np.sqrt(band[0] * band[1]))
        powers = [np.mean(_within(one, band, motion.step) ** 2, axis=0) for one in drawn]
        noise = np.mean(powers, axis=0)
        parts = [_within(motion.qdd[part], band, motion.step) for part in motion.parts]
        shown = np.concatenate(parts)
        rate = np.concatenate([np.gradient(part, motion.step, axis=0) for part in parts]) / middle
        share = np.minimum(noise / np.maximum(np.mean(shown**2, axis=0), 1e-12), 1.0)
        for j in np.flatnonzero(share > LEAST):
            columns += [share[j] * M[:, :, j] * signal[:, j, None] for signal in (shown, rate)]
    return np.stack(columns, axis=2) if columns else np.zeros((len(motion.time), motion.n, 0))


def _within(signal: Array, band: tuple[float, float], step: float) -> Array:
    """The part of a signal in a band of frequencies, along the first axis."""
    half = min(int(np.ceil(HALF_LENGTH / step)), (len(signal) - 1) // 2)
    weights = firwin(2 * half + 1, band, fs=1.0 / step, pass_zero=False)
    return np.asarray(convolve1d(signal, weights, axis=0, mode="nearest"))
