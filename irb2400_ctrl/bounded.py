"""The least of a parabola above lower bounds."""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dposv
from scipy.optimize import lsq_linear

from irb2400_ctrl.arrays import Array

PATIENCE = 3
"""times that as many may be on the wrong side of their bounds as before"""
MOST_PIVOTS = 200
"""guesses of what lies on its bound"""


def bounded_minimum(A: Array, b: Array, least: Array) -> Array:
    """Minimum of z A z / 2 - b z with z >= least, A positive definite.

    Which z lie on their bound is guessed and mended: all at once that are on the wrong side, and
    one by one where that helps no more, which ends (Judice, Pires, A block principal pivoting
    algorithm for large-scale strictly monotone linear complementarity problems, 1994).

    Args:
        A: curvature, shape (k, k); b: slope at nothing, (k,).
        least: bounds, (k,); minus infinity where there is none.
    """
    free = np.ones(len(b), dtype=bool)
    slack = 1e-12 * np.abs(b).max()
    fewest = len(b) + 1
    patience = PATIENCE
    for _ in range(MOST_PIVOTS):
        if free.all():
            z = _solved(A, b)
        else:
            z = np.where(free, 0.0, least)
            z[free] = _solved(A[np.ix_(free, free)], b[free] - A[free] @ z)
        wrong = np.where(free, z < least, A @ z - b < -slack)
        count = int(wrong.sum())
        if not count:
            return np.asarray(z)
        if count < fewest:
            fewest = count
            patience = PATIENCE
        elif patience:
            patience -= 1
        else:
            wrong[: np.flatnonzero(wrong)[-1]] = False
        free ^= wrong
    L = np.linalg.cholesky(A)
    found = lsq_linear(L.T, np.linalg.solve(L, b), bounds=(least, np.inf), method="bvls")
    return np.asarray(found.x)


def _solved(A: Array, b: Array) -> Array:
    """A^-1 b, by halves where rounding leaves A positive definite."""
    _, x, info = dposv(A, b, lower=1)
    return np.asarray(x if info == 0 else np.linalg.solve(A, b))
