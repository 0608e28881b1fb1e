"""Whether a log's angles are the commanded ones behind a servo, and which of the two are used."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.motion.angle_smoothing import white_on_grid
from irb2400_ctrl.measurement.uniform import UniformLog, derivative_margin, smoothed, widened

SPACING = 0.008
"""[s] between the taps of the response"""
LAG = 0.120
"""[s] longest lag of the response"""
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


def followed(log: UniformLog) -> Array:
    """The commanded motion through the fitted servo response, shape (m, n) [rad].

    Taps every 8 ms over 120 ms, least squares on the gap-free samples, unit gain at rest; over the
    first 120 ms the measured angles. It follows the measured motion without its noise, so
    regressors built on it are not correlated with that noise (instrumental variables; Janot,
    Vandanjon, Gautier 2014).
    """
    assert log.q_ref is not None
    stride = max(1, round(SPACING / log.step))
    taps = max(2, round(LAG / (stride * log.step)))
    span = stride * taps
    good = ~widened(~log.valid, span)
    good[:span] = False
    q_hat = log.q.copy()
    for j in range(log.q.shape[1]):
        ref = log.q_ref[:, j]
        # differences to the newest sample: the sum of the taps is one by construction
        lagged = np.column_stack([np.roll(ref, stride * k) - ref for k in range(1, taps + 1)])
        X = lagged[good]
        y = (log.q[:, j] - ref)[good]
        if np.abs(X).max(initial=0.0) < 1e-6:
            q_hat[:, j] = ref + y.mean()
            continue
        scale = np.linalg.norm(X) / np.sqrt(taps)
        weights = np.linalg.lstsq(
            np.vstack([X, 1e-6 * scale * np.eye(taps)]), np.append(y, np.zeros(taps)), rcond=None
        )[0]
        q_hat[:, j] = ref + lagged @ weights
    q_hat[:span] = log.q[:span]
    return q_hat
