"""Unrolled solve with a symmetric positive definite matrix."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class Factors:
    """A = L D L^T with unit lower L; the reciprocals of D, because a division costs as much as ten
    products."""

    L: ca.SX
    reciprocals: list[ca.SX]

    def solve(self, b: ca.SX) -> ca.SX:
        """x with A x = b, shape (n, m)."""
        n = self.L.shape[0]
        rows = ca.vertsplit(b)
        for i in range(n):
            for k in range(i):
                rows[i] = rows[i] - self.L[i, k] * rows[k]
        rows = [row * r for row, r in zip(rows, self.reciprocals, strict=True)]
        for i in reversed(range(n)):
            for k in range(i + 1, n):
                rows[i] = rows[i] - self.L[k, i] * rows[k]
        return ca.vertcat(*rows)


def factorise(A: ca.SX) -> Factors:
    """L D L^T of a symmetric positive definite A, shape (n, n)."""
    n = A.shape[0]
    L = ca.SX.eye(n)
    scaled = ca.SX(n, n)
    reciprocals = []
    for j in range(n):
        for i in range(j, n):
            # scaled = L D
            scaled[i, j] = A[i, j] - sum((L[i, k] * scaled[j, k] for k in range(j)), ca.SX(0))
        reciprocals.append(1 / scaled[j, j])
        for i in range(j + 1, n):
            L[i, j] = scaled[i, j] * reciprocals[j]
    return Factors(L, reciprocals)


def solve_ldl(A: ca.SX, b: ca.SX) -> ca.SX:
    """x with A x = b; A symmetric positive definite, shape (n, n)."""
    return factorise(A).solve(b)
