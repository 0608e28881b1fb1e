"""Plain least squares over base parameters, friction, offset and rotor: the known anchor."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.moments import Moments

CUT = 1e-9
"""singular values below this, over the largest, belong to combinations that nobody can see"""
ROUNDS = 6


def plain_least_squares(sums: Moments) -> Array:
    """The shortest theta that minimises the squares, each joint over what it leaves, shape (p,)."""
    data = sums.summed()
    count = np.maximum(data.count[0], 1.0)
    sigma = np.sqrt(np.maximum(data.c[0] / count, 1e-12))
    theta = np.zeros(data.g.shape[-1])
    for _ in range(ROUNDS):
        weight = 1.0 / sigma**2
        A = np.einsum("n,bnpq->pq", weight, data.H)
        b = np.einsum("n,bnp->p", weight, data.g)
        theta = shortest_inverse(A) @ b
        left = data.squared_error(theta)[0] / count
        sigma = np.sqrt(np.maximum(left, 1e-12 * data.c[0] / count + 1e-18))
    return theta


def shortest_inverse(A: Array) -> Array:
    """Inverse of normal equations, each number over its own size, zero for the combinations that
    nobody can see, shape (p, p): it leads to the shortest numbers."""
    size = np.sqrt(np.diag(A)) + 1e-12
    inverse = np.linalg.pinv(A / size[:, None] / size, rcond=CUT, hermitian=True)
    return np.asarray(inverse / size[:, None] / size)
