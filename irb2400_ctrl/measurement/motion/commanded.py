"""Whether a log's angles are the commanded ones behind a servo, and which of the two are used."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.motion.angle_smoothing import white_on_grid
from irb2400_ctrl.measurement.motion.servo import followed
from irb2400_ctrl.measurement.uniform import UniformLog, derivative_margin, smoothed, widened

BLEND = 0.2
"""[s] at the start, over which the commanded motion, whose history is not known, is blended in"""
LEFT_OF_NOISE = 1.0
"""smoothed over unsmoothed rms below which a difference is noise, at 250 Hz (white noise: 0.4)"""
NOISE_RESERVE = 1.5
"""the same over what white noise has, at lower rates"""


def used_angles(log: UniformLog, recorded: Log) -> tuple[Array, bool, tuple[int, ...]]:
    """Angles to build the regressors on, whether all come from the commanded motion, and the joints
    (from 1) that do not follow it.

    Args:
        log: on a grid; recorded: the same on its own samples.
    """
    if log.q_ref is None:
        return log.q, False, ()
    ideal = followed(log)
    difference = log.q - ideal
    smooth = smoothed(difference, log.step)
    good = ~widened(~log.valid, derivative_margin(log.step))
    good[: round(BLEND / log.step)] = False
    noise = np.std((difference - smooth)[good], axis=0)
    # more than what white noise leaves after the smoothing is real motion
    real = np.std(smooth[good], axis=0) > _left_of_noise(log, recorded) * noise + 1e-7
    start = round(BLEND / log.step)
    # the first samples have no history to be predicted from: blend from the measured angles
    ramp = np.clip(np.arange(len(ideal)) / start, 0.0, 1.0)[:, None]
    q = np.where(real, log.q, ideal + (1.0 - ramp) * difference)
    return q, not real.any(), tuple(int(j) + 1 for j in np.flatnonzero(real))


def _left_of_noise(log: UniformLog, recorded: Log) -> float:
    """Smoothed over unsmoothed rms, with a reserve, that white noise on a log's own samples has
    after resampling: on a finer grid it is no longer white."""
    drawn = white_on_grid(recorded, log.step)
    smooth = smoothed(drawn, log.step)
    ratio = np.std(smooth[log.valid]) / np.std((drawn - smooth)[log.valid])
    return max(LEFT_OF_NOISE, NOISE_RESERVE * float(ratio))
