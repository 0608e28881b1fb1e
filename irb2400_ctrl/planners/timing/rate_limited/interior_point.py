"""`solve`: Newton's method on barrier problems of a `RateLimitedProgram`, primal-dual, from a point
inside to the optimum.

    minimise  T(z) - mu sum log slack(z),      mu falling to zero

A step stays inside: slacks of rates lie above their linearisation, and every trial is checked.
What bends against the minimum enters the Hessian as long as that stays positive definite. All
matrices have five bands: the cost of a step is that of the rows, linear in the number of cells.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_program import (
    RateLimitedProgram,
    squared,
)

_MOST = 150
# part of the way to the boundary that a step may go
_TO_BOUNDARY = 0.99
# next barrier: when the last one is solved up to so many times its own gap
_SOLVED = 3.0
_SMALLER = 0.2
# multipliers stay within this factor of the barrier's own
_SPREAD = 100.0
# of its diagonal, added to a matrix that rounding keeps from being positive definite
_MORE = (0.0, 1e-13, 1e-11, 1e-9, 1e-7)


@dataclass(frozen=True)
class Solution:
    """Where the iterations ended; always inside the limits of the program."""

    z: Array
    duration: float
    """[s]"""
    gap: float
    """estimate of how much longer than the optimum, as a part of the duration"""
    iterations: int


def solve(
    program: RateLimitedProgram, z: Array, *, barrier: float = 1.0, gap: float = 1e-4
) -> Solution:
    """The shortest duration near a motion that keeps all limits.

    Args:
        program: objective and rows.
        z: unknowns strictly inside.
        barrier: weight of all logarithms together to start with, as a part of the duration.
        gap: where to stop, as a part of the duration.
    """
    point = _Point.at(program, z)
    mu = barrier * point.duration / point.slack.size
    multipliers = mu / point.slack
    iterations = 0
    complementarity = 0.0
    while iterations < _MOST:
        complementarity = float(multipliers @ point.slack)
        error = max(complementarity, point.stationarity(multipliers))
        if error <= gap * point.duration:
            break
        iterations += 1
        if error <= _SOLVED * mu * point.slack.size:
            mu *= _SMALLER
        gradient = point.gradient - point.pulled(mu / point.slack)
        dz = _newton(point, multipliers, gradient)
        if dz is None:
            break
        ds = point.along(dz)
        step = _to_boundary(point.slack, ds)
        new = _searched(point, dz, step, mu, float(gradient @ dz))
        if new is None:
            break
        change = (mu - multipliers * ds) / point.slack - multipliers
        multipliers = multipliers + change * _to_boundary(multipliers, change)
        point = new
        central = mu / point.slack
        multipliers = np.clip(multipliers, central / _SPREAD, central * _SPREAD)
    return Solution(point.z, point.duration, complementarity / point.duration, iterations)


def _to_boundary(values: Array, change: Array) -> float:
    """The step, at most one, that leaves positive values positive."""
    return min(1.0, _TO_BOUNDARY / max(float((-change / values).max()), 1e-9))


@dataclass(frozen=True, eq=False)
class _Point:
    """Objective and rows at one place; the rows of the end cells come last."""

    program: RateLimitedProgram
    z: Array
    duration: float
    gradient: Array
    hessian: Array
    slack: Array
    """shape (rows,)"""
    slopes: Array
    """of the inner rows by local unknowns, shape (m - 2, K, 3)"""
    end_slopes: Array
    """shape (2, K)"""

    @classmethod
    def at(cls, program: RateLimitedProgram, z: Array) -> _Point:
        slack, slopes = program.rows(z)
        ends, end_slopes = program.end_rows(z)
        return cls(
            program,
            z,
            *program.duration(z),
            np.concatenate([slack.ravel(), ends.ravel()]),
            slopes,
            end_slopes,
        )

    def stationarity(self, multipliers: Array) -> float:
        """How far the gradient of the Lagrangian is from zero, in units of the unknowns."""
        residual = self.gradient - self.pulled(multipliers)
        return float(np.abs(residual * self.z).sum())

    def _split(self, rows: Array) -> tuple[Array, Array]:
        inner = self.slopes.shape[0] * self.slopes.shape[1]
        return rows[:inner].reshape(self.slopes.shape[:2]), rows[inner:].reshape(
            self.end_slopes.shape
        )

    def pulled(self, rows: Array) -> Array:
        """Derivatives of the slacks, transposed, times numbers of the rows."""
        inner, ends = self._split(rows)
        found = self.program.spline.gather(np.matmul(inner[:, None], self.slopes)[:, 0])
        found[[0, -1]] += (ends * self.end_slopes).sum(axis=1)
        return found

    def along(self, dz: Array) -> Array:
        """Change of the slacks in a direction, to first order."""
        inner = np.matmul(self.slopes, dz[self.program.spline.place][..., None])[..., 0]
        return np.concatenate([inner.ravel(), (self.end_slopes * dz[[0, -1], None]).ravel()])

    def squared(self, weights: Array) -> Array:
        """Upper bands of the derivatives, transposed, times weights, times the derivatives."""
        inner, ends = self._split(weights)
        found = self.program.spline.banded(squared(self.slopes, inner))
        found[2, [0, -1]] += (ends * self.end_slopes**2).sum(axis=1)
        return found


def _newton(point: _Point, multipliers: Array, gradient: Array) -> Array | None:
    """The step; None where no matrix near the Hessian is positive definite."""
    from scipy.linalg import LinAlgError, solveh_banded

    N = point.hessian + point.squared(multipliers / point.slack)
    bend = point.program.curvature(point.z, point._split(multipliers)[0])
    for part, more in ((1.0, 0.0), (0.5, 0.0), *((0.0, more) for more in _MORE)):
        H = N - part * bend
        H[2] += more * N[2]
        with suppress(LinAlgError):
            return np.asarray(solveh_banded(H, -gradient))
    return None


def _searched(point: _Point, dz: Array, step: float, mu: float, slope: float) -> _Point | None:
    """The point at the largest of the halved steps that stays inside and lowers the barrier
    function enough."""
    merit = point.duration - mu * np.log(point.slack).sum()
    for _ in range(30):
        z = point.z + step * dz
        slack = point.program.slacks(z)
        if slack.min() > 0:
            value = point.program.duration(z)[0] - mu * np.log(slack).sum()
            if value <= merit + 1e-4 * step * slope + 1e-9 * abs(merit):
                return _Point.at(point.program, z)
        step /= 2
    return None
