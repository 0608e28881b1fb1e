"""Coefficients with unit priors under the noise of each joint."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.preparation.noise import Noise


class Posterior:
    """Of b in y = X b + e, b ~ N(0, 1): everything follows from small sums over the rows."""

    def __init__(self, y: Array, columns: Array, noise: Sequence[Noise]) -> None:
        """Only the sums are taken.

        Args:
            y: shape (rows, n) [Nm]; columns: X, (rows, n, k); noise: e, per joint.
        """
        self._A = np.eye(columns.shape[2])
        self._right = np.zeros(columns.shape[2])
        self._squares = 0.0
        for j, one in enumerate(noise):
            X = one.whiten(columns[:, j, :])
            v = one.whiten(y[:, j])
            self._A += X.T @ X
            self._right += X.T @ v
            self._squares += float(v @ v)

    @cached_property
    def covariance(self) -> Array:
        """Shape (k, k)."""
        return np.asarray(np.linalg.inv(self._A), dtype=float)

    @cached_property
    def mean(self) -> Array:
        """Shape (k,)."""
        return np.asarray(self.covariance @ self._right)

    def misfit(self, free: Mask) -> float:
        """Whitened sum of squares, the prior's included, that is left where these columns (k,)
        alone are fitted."""
        right = self._right[free]
        return self._squares - float(right @ np.linalg.solve(self._A[np.ix_(free, free)], right))
