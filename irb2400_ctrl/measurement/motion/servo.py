"""Servo response: what the arm does of what it is told, q = (h * q_ref), fitted per joint."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.uniform import UniformLog, widened

SPACING = 0.008
"""[s] between the taps of the response"""
LAG = 0.120
"""[s] longest lag of the response"""


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
