"""`JointPath`: joint angles as cubics over the length of the path, or over the time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.typed import typed

# pieces that are worked on at once
_AT_ONCE = 4096
# what the powers of d are multiplied with in the derivatives of order 0, 1, 2, 3
_POWERS = ((1.0, 1.0, 1.0, 1.0), (1.0, 2.0, 3.0), (2.0, 6.0), (6.0,))


class JointMotion(Protocol):
    """Angles and two derivatives by a parameter, in pieces: what can be enclosed."""

    @property
    def knots(self) -> Array:
        """Ends of the pieces, increasing, shape (m + 1,)."""

    def piece(self, s: Array) -> npt.NDArray[np.int64]:
        """Number of the piece that each s lies in."""

    def __call__(self, s: Array, order: int = 0) -> Array:
        """Angles, or the derivative of the given order, shape (k, n)."""

    def on_piece(self, s: Array, piece: npt.NDArray[np.int64], order: int = 0) -> Array:
        """The same with the piece chosen by the caller."""

    def taken(self, first: Array, last: Array) -> JointMotion:
        """Stretches between parameters first and last (k,), each within a piece, put one after
        another."""

    def spread(self, s: Array, R: Array) -> tuple[Array, Array, Array]:
        """By how much angles, first and second derivatives differ at most from those at s on
        complex circles of radius R, each (k, n)."""

    def reversals(self) -> Array:
        """Zeros of first derivatives inside the pieces, sorted."""


@dataclass(frozen=True)
class JointPath:
    """q(s), a cubic in s - s_k between the knots s_k; a path to be timed is twice continuously
    differentiable."""

    knots: Array
    """lengths along the path [m], increasing, shape (m + 1,)"""
    coefficients: Array
    """q(s) = sum_p coefficients[p, k] (s - s_k)^p, shape (4, m, n)"""

    def __post_init__(self) -> None:
        m = len(self.knots) - 1
        if m < 1 or self.coefficients.shape[:2] != (4, m) or not (np.diff(self.knots) > 0).all():
            raise InputError(
                f"joint path: found {len(self.knots)} knots and coefficients "
                f"{self.coefficients.shape}, "
                "expected increasing knots and shape (4, knots - 1, n)"
            )
        self.knots.setflags(write=False)
        self.coefficients.setflags(write=False)

    @classmethod
    @typed
    def through(cls, s: Array, q: Array) -> JointPath:
        """The interpolating spline through q (m, n) [rad] at lengths s (m,) (not-a-knot ends)."""
        from scipy.interpolate import CubicSpline

        # too few points for not-a-knot: straight in joint space for two, natural for three
        spline = CubicSpline(s, q, bc_type="natural" if len(s) < 4 else "not-a-knot")
        return cls(np.array(s, dtype=float), np.ascontiguousarray(spline.c[::-1]))

    @classmethod
    def hermite(cls, time: Array, q: Array, qd: Array) -> JointPath:
        """q(t) with the time as its parameter: between rows at the times (m,) [s] the cubic that
        has their angles [rad] and speeds [rad/s], each (m, n).

        Args:
            time: [s], shape (m,).
            q: [rad], shape (m, n).
            qd: [rad/s], shape (m, n).
        """
        return cls.joining(time, (q[:-1], qd[:-1]), (q[1:], qd[1:]))

    @classmethod
    def joining(
        cls, time: Array, start: tuple[Array, Array], end: tuple[Array, Array]
    ) -> JointPath:
        """Pieces one after another, each the cubic that has the angles and the speeds of its start
        and its end, (m - 1, n); one need not begin where the one before ends.

        Args:
            time: of starts and ends [s], shape (m,).
            start: angles [rad] and speeds [rad/s], (m - 1, n) each.
            end: likewise.
        """
        h = np.diff(time)[:, None]
        # into their places: of a long motion each is several MB
        found = np.empty((4, *start[0].shape))
        q, qd, bend, third = found
        q[:], qd[:] = start
        mean = (end[0] - q) / h
        np.subtract(3 * mean - 2 * qd, end[1], out=bend)
        bend /= h
        np.subtract(qd + end[1], 2 * mean, out=third)
        third /= h**2
        return cls(time.copy(), found)

    @classmethod
    def lines(cls, time: Array, start: Array, end: Array) -> JointPath:
        """The same with straight pieces.

        Args:
            time: [s], shape (m,).
            start: angles of the pieces' starts [rad], shape (m - 1, n).
            end: of their ends, likewise.
        """
        slope = (end - start) / np.diff(time)[:, None]
        nothing = np.zeros_like(slope)
        return cls(time.copy(), np.stack([start, slope, nothing, nothing]))

    @classmethod
    def straight(cls, time: Array, q: Array) -> JointPath:
        """q(t), linear between rows at the times (m,) [s]; q in any unit, shape (m, n)."""
        return cls.lines(time, q[:-1], q[1:])

    def taken(self, first: Array, last: Array) -> JointPath:
        """The stretches between the lengths first and last (k,), each within a piece, put one after
        another."""
        piece = self.piece((first + last) / 2)
        q, dq, ddq = (self.on_piece(first, piece, order) for order in (0, 1, 2))
        width = np.cumsum(last - first)
        # they end where the last one does: lengths are rounded as they were
        knots = last[-1] - width[-1] + np.append(0.0, width)
        return JointPath(knots, np.stack([q, dq, ddq / 2, self.coefficients[3, piece]]))

    def first(self, n: int) -> JointPath:
        """The first n joints alone."""
        return JointPath(self.knots, self.coefficients[:, :, :n]) if n < self.n else self

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.coefficients.shape[2])

    @property
    def length(self) -> float:
        """Total length [m]."""
        return float(self.knots[-1] - self.knots[0])

    def piece(self, s: Array) -> npt.NDArray[np.int64]:
        """Number of the polynomial piece that each s lies in."""
        return np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.knots) - 2)

    def __call__(self, s: Array, order: int = 0) -> Array:
        """The derivative of the given order by s, shape (k, n) [rad/m^order]."""
        s = np.atleast_1d(np.asarray(s, dtype=float))
        return self.on_piece(s, self.piece(s), order)

    def on_piece(self, s: Array, piece: npt.NDArray[np.int64], order: int = 0) -> Array:
        """The same with the polynomial piece chosen by the caller (for one-sided values at
        knots).

        Args:
            s: way [m], shape (k,); piece: of each, from 0, shape (k,).
            order: of the derivative.
        """
        d = np.repeat(s - self.knots[piece], self.n).reshape(-1, self.n)
        # Horner's rule; a coefficient is gathered only where it enters
        value = self._times(order, 3, piece)
        for power in range(2, order - 1, -1):
            value *= d
            value += self._times(order, power, piece)
        return value

    def _times(self, order: int, power: int, piece: npt.NDArray[np.int64]) -> Array:
        """A coefficient of the pieces, with its factor in a derivative, shape (k, n)."""
        gathered = self.coefficients[power].take(piece, axis=0)
        factor = _POWERS[order][power - order]
        if factor != 1:
            gathered *= factor
        return np.asarray(gathered)

    def spread(self, s: Array, R: Array) -> tuple[Array, Array, Array]:
        """By how much q, q' and q'' differ at most from those at s (k,) on circles of radius R
        (k,) in the complex plane, each (k, n)."""
        piece = self.piece(s)
        dq, ddq, dddq = (np.abs(self.on_piece(s, piece, order)) for order in (1, 2, 3))
        r = R[:, None]
        return dq * r + ddq * r**2 / 2 + dddq * r**3 / 6, ddq * r + dddq * r**2 / 2, dddq * r

    def reversals(self) -> Array:
        """Zeros of q_j'(s) inside the pieces, all joints together, sorted [m]."""
        pieces = range(0, len(self.knots) - 1, _AT_ONCE)
        return np.unique(np.concatenate([self._reversals(k, k + _AT_ONCE) for k in pieces]))

    def _reversals(self, first: int, last: int) -> Array:
        """Of some of the pieces, not sorted."""
        _, c1, c2, c3 = self.coefficients[:, first:last]
        knots = self.knots[first : last + 1]
        width = np.diff(knots)[:, None]
        # roots of c1 + 2 c2 d + 3 c3 d^2 without cancellation
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            root = np.sqrt(c2**2 - 3 * c3 * c1)
            t = -(c2 + np.where(c2 >= 0, root, -root))
            found = np.concatenate([t / (3 * c3), c1 / t])
        inside = (found > 0) & (found < np.concatenate([width, width]))
        begin = np.concatenate([knots[:-1], knots[:-1]])[:, None]
        return np.asarray((np.broadcast_to(begin, found.shape) + found)[inside])
