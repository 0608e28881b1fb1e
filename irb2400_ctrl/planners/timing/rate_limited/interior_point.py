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
from irb2400_ctrl.planners.timing.rate_limited import cell_rows
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_program import RateLimitedProgram

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


def solve(
    program: RateLimitedProgram, z: Array, *, barrier: float = 1.0, gap: float = 1e-4
) -> Array:
    """The unknowns of the shortest duration near a motion that keeps all limits; always inside.

    Args:
        program: objective and rows.
        z: unknowns strictly inside.
        barrier: weight of all logarithms together to start with, as a part of the duration.
        gap: where to stop, as a part of the duration.
    """
    point = _Point.at(program, z)
    mu = barrier * point.duration / point.slack.size
    multipliers = mu / point.slack
    for _ in range(_MOST):
        first = point.linearised(multipliers, mu)
        error = max(float(multipliers @ point.slack), first.stationarity(point.z))
        if error <= gap * point.duration:
            break
        gradient = first.gradient(mu)
        if error <= _SOLVED * mu * point.slack.size:
            mu *= _SMALLER
            gradient = first.gradient(mu)
        dz = _newton(first, gradient)
        if dz is None:
            break
        relative = program.along(point.z, dz, point.slack)
        primal, dual = cell_rows.steepest(point.slack, multipliers, relative, mu)
        new = _searched(point, dz, _to_boundary(primal), mu, float(gradient @ dz))
        if new is None:
            break
        multipliers = cell_rows.updated(
            multipliers, point.slack, relative, new.slack, mu, _to_boundary(dual), _SPREAD
        )
        point = new
    return point.z


def _to_boundary(steepest: float) -> float:
    """The step, at most one, that leaves positive values positive, of which the whole one takes so
    large a part."""
    return min(1.0, _TO_BOUNDARY / max(steepest, 1e-9))


@dataclass(frozen=True, eq=False)
class _Point:
    """A motion inside."""

    program: RateLimitedProgram
    z: Array
    duration: float
    slack: Array
    """shape (rows,)"""
    logarithms: float
    """sum of those of the slacks"""

    @classmethod
    def at(cls, program: RateLimitedProgram, z: Array) -> _Point:
        slack, logarithms = program.slacks(z)
        return cls(program, z, program.duration(z), slack, logarithms)

    def merit(self, mu: float) -> float:
        """The barrier function; inf outside."""
        return self.duration - mu * self.logarithms

    def linearised(self, multipliers: Array, mu: float) -> _Linearised:
        """First and second derivatives here."""
        gradient, hessian = self.program.duration_slopes(self.z)
        central, *found = self.program.sums(self.z, self.slack, multipliers, mu)
        return _Linearised(gradient, hessian, central / mu, *found)


@dataclass(frozen=True, eq=False)
class _Linearised:
    """Derivatives at a point, with its multipliers."""

    duration: Array
    """gradient of the duration"""
    hessian: Array
    """upper bands of its Hessian"""
    central: Array
    """slopes of the slacks over the slacks"""
    pulled: Array
    """slopes of the slacks times the multipliers"""
    squares: Array
    """upper bands of slopes times multipliers / slack times slopes"""
    bend: Array
    """upper bands of what the rows' bends take from the Hessian"""

    def gradient(self, mu: float) -> Array:
        """Of the barrier function."""
        return self.duration - mu * self.central

    def stationarity(self, z: Array) -> float:
        """How far the gradient of the Lagrangian is from zero, in units of the unknowns."""
        return float(np.abs((self.duration - self.pulled) * z).sum())


def _newton(at: _Linearised, gradient: Array) -> Array | None:
    """The step; None where no matrix near the Hessian is positive definite."""
    from scipy.linalg import LinAlgError, solveh_banded

    N = at.hessian + at.squares
    for part, more in ((1.0, 0.0), (0.5, 0.0), *((0.0, more) for more in _MORE)):
        H = N - part * at.bend
        H[2] += more * N[2]
        with suppress(LinAlgError):
            return np.asarray(solveh_banded(H, -gradient))
    return None


def _searched(point: _Point, dz: Array, step: float, mu: float, slope: float) -> _Point | None:
    """The point at the largest of the halved steps that stays inside and lowers the barrier
    function enough."""
    merit = point.merit(mu)
    for _ in range(30):
        new = _Point.at(point.program, point.z + step * dz)
        if new.merit(mu) <= merit + 1e-4 * step * slope + 1e-9 * abs(merit):
            return new
        step /= 2
    return None
