"""Mean and covariance of coefficients with unit priors under the noise of each joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.noise import Noise


def posterior(y: Array, columns: Array, noise: Sequence[Noise]) -> tuple[Array, Array]:
    """Mean (k,) and covariance (k, k) of b in y = X b + e, b ~ N(0, 1).

    Args:
        y: shape (rows, n) [Nm]; columns: X, (rows, n, k); noise: e, per joint.
    """
    k = columns.shape[2]
    A = np.eye(k)
    right = np.zeros(k)
    for j, one in enumerate(noise):
        X = one.whiten(columns[:, j, :])
        A += X.T @ X
        right += X.T @ one.whiten(y[:, j])
    covariance = np.asarray(np.linalg.inv(A), dtype=float)
    return covariance @ right, covariance
