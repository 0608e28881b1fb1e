"""`Knots`: a motion as a cubic spline in time, as solvers of free geometry start from it and leave
it."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.arrays import Array


@dataclass(frozen=True)
class Knots:
    """A motion as knots of a cubic spline in time."""

    time: Array
    """[s], shape (m + 1,)"""
    q: Array
    qd: Array
    qdd: Array
    """[rad], [rad/s], [rad/s2], shape (m + 1, n)"""


@dataclass(frozen=True)
class Solved:
    """What the solver left."""

    knots: Knots
    converged: bool
    status: str
    """IPOPT's return status"""
    iterations: int
    wall_time: float
    """of the solver alone [s]"""
