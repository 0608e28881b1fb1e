"""What a name is worth on rows that did not fit it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter

FOLDS = 4
BLOCK = 2.0
"""[s] length of the stretches that are held out, at most"""
LEAST_BLOCKS = 3
"""stretches of each fold, at least"""
FREE = 1e-2
"""precision of an effect's own numbers about the fitted ones: a fold has to find them itself"""


class HeldOut:
    """Errors on stretches of a log that everything is fitted without, in turn.

    Stretches of different folds lie between each other, so that what grows with time is
    interpolated and an event of some seconds is seen by all folds.
    """

    def __init__(self, fitter: Fitter, chosen: Sequence[Candidate], fit: Fit) -> None:
        self.fitter = fitter
        self.chosen = chosen
        self.fit = fit
        self.fold = folds(fitter.motion.row_time)
        self.left = self._left(fit)
        """held-out residual with everything in, shape (rows, n) [Nm]"""

    def gain(self, place: int) -> Array:
        """Per cent by which the held-out rms of each joint falls because one of `chosen` is in,
        shape (n,); negative where the name only makes it worse."""
        others = [c for k, c in enumerate(self.chosen) if k != place]
        without = self.fitter.fit(others)
        return self._gain(self._left(without))

    def gain_of(self, torque: Array) -> Array:
        """The same for a torque (rows, n) [Nm] that other numbers of the robot could take in, were
        they not held where they are."""
        return self._gain(self.left + torque)

    def _gain(self, without: Array) -> Array:
        known = self.fitter.motion.row_known
        before, after = (
            np.sum(np.where(known, left, 0.0) ** 2, axis=0) for left in (without, self.left)
        )
        return np.asarray(100.0 * (1.0 - np.sqrt(after / np.maximum(before, 1e-12))))

    def _left(self, fit: Fit) -> Array:
        """What ridge regression on the other folds leaves, shape (rows, n)."""
        y = fit.y
        columns = fit.Z
        precision = np.ones(columns.shape[2])
        start = int(np.sum(fit.owner < 0))
        precision[start : start + len(fit.parameters)] = FREE
        grams = np.zeros((FOLDS, len(precision), len(precision)))
        rights = np.zeros((FOLDS, len(precision)))
        for j, one in enumerate(self.fit.noise):
            X = one.whiten(columns[:, j, :])
            v = one.whiten(y[:, j])
            for k in range(FOLDS):
                rows = self.fold[one.kept] == k
                grams[k] += X[rows].T @ X[rows]
                rights[k] += X[rows].T @ v[rows]
        left = np.zeros_like(y)
        for k in range(FOLDS):
            gram = np.delete(grams, k, axis=0).sum(axis=0)
            right = np.delete(rights, k, axis=0).sum(axis=0)
            b = np.linalg.solve(gram + np.diag(precision), right)
            rows = self.fold == k
            left[rows] = y[rows] - columns[rows] @ b
        return left


def folds(time: Array) -> npt.NDArray[np.intp]:
    """Fold of each row, shape (rows,)."""
    elapsed = time - time[0]
    block = min(BLOCK, float(elapsed[-1]) / (FOLDS * LEAST_BLOCKS))
    return np.asarray((elapsed / block).astype(np.intp) % FOLDS)
