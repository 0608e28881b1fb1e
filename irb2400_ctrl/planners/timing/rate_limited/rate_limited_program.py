"""`RateLimitedProgram`: the shortest duration under limits of torque and torque rate, as a program
with few neighbours.

Unknown are the control points z of x(s) = sdot^2 (`SpeedSpline`): u = x'/2 is continuous and linear
in each cell. With the outputs y = a u + b x + e sqrt(x) + c + dry friction of `ConstrainedOutputs`,
at both ends and the middle of every cell,

    |y| <= limit,        |(a' + 2 b) u + a u' + b' x + c' + (e u + e' x) / sqrt(x)| <= rate /
    sqrt(x).

The left side of the second is linear in z but for the small e, and the right one convex: its
tangent is a smaller limit. A slow enough motion is within all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import ConstrainedOutputs
from irb2400_ctrl.planners.timing.rate_limited.speed_spline import SpeedSpline

# where the rows stand in a cell: Bernstein polynomials there, half their slopes, and their bend
_AT = np.array([0.0, 0.5, 1.0])
_VALUE = bernstein.basis(2, _AT)
_SLOPE = bernstein.basis(1, _AT) @ np.diff(np.eye(3), axis=0)
_BEND = np.diff(np.eye(3), 2, axis=0)[0]
# Gauss's rule with three points on [0, 1]
_NODES = 0.5 + np.sqrt(0.15) * np.array([-1.0, 0.0, 1.0])
_GAUSS = bernstein.basis(2, _NODES)
_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18


@dataclass(frozen=True)
class _State:
    """A motion at three places of every inner cell, shapes (m - 2, 3, 1) or (m - 2, 3, k)."""

    x: Array
    u: Array
    bend: Array
    """du/ds"""
    root: Array
    """sqrt(x)"""
    bernstein: Array
    """coefficients of x, shape (m - 2, 3)"""
    viscous: Array
    """part of the rates that e contributes, over sqrt(x)"""
    spare: Array
    """rates that may be used, over sqrt(x), as their constraints are scaled"""


@dataclass(frozen=True, eq=False)
class RateLimitedProgram:
    """Rows and objective on m cells, the first and the last of them at rest at one end; m - 2 > 3
    unknowns."""

    outputs: ConstrainedOutputs
    """k of them on all m cells"""
    bound: Array
    """of x at the grid points, shape (m + 1,)"""
    reference: Array
    """x of about the motion looked for, for the scale of the rows, shape (m + 1,)"""
    keep: tuple[Array, Array]
    """parts of the limits, and of the rates, that may be used in each cell, shapes (m, k)"""

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.outputs.h) - 2

    @cached_property
    def spline(self) -> SpeedSpline:
        """x(s) from the unknowns."""
        return SpeedSpline(self.outputs.h)

    # ---- objective

    def duration(self, z: Array) -> tuple[float, Array, Array]:
        """Duration [s], its gradient and its Hessian (upper bands)."""
        h = self.outputs.h
        weight = h[1:-1, None] * _WEIGHTS
        root = np.sqrt(self.spline.bernstein(z) @ _GAUSS.T)
        value = float((weight / root).sum()) + 3 * h[0] / np.sqrt(z[0]) + 3 * h[-1] / np.sqrt(z[-1])
        gradient = self.spline.gather(
            np.matmul((-weight / (2 * root**3))[:, None], self._gauss)[:, 0]
        )
        H = self.spline.banded(squared(self._gauss, 0.75 * weight / root**5))
        for end in (0, -1):
            gradient[end] -= 1.5 * h[end] / z[end] ** 1.5
            H[2, end] += 2.25 * h[end] / z[end] ** 2.5
        return value, gradient, H

    @cached_property
    def _gauss(self) -> Array:
        return np.asarray(np.matmul(_GAUSS, self.spline.to_bernstein))

    # ---- constraints of the inner cells

    @cached_property
    def _coefficients(self) -> tuple[Array, ...]:
        """a, b, e, c_high, c_low and their derivatives at the three places, each (m - 2, 3, k)."""
        c = self.outputs
        h = self.outputs.h[1:-1, None, None]
        parabolas = [f[1:-1] for f in (c.a, c.b, c.e, c.c_high, c.c_low)]
        return (
            *(np.matmul(_VALUE, f) for f in parabolas),
            *(2 / h * np.matmul(_SLOPE, f) for f in parabolas),
        )

    @cached_property
    def _motion(self) -> tuple[Array, Array, Array]:
        """x, u and u' at the three places from local unknowns, each (m - 2, 3 or 1, 3)."""
        E = self.spline.to_bernstein
        h = self.outputs.h[1:-1, None, None]
        return np.matmul(_VALUE, E), np.matmul(_SLOPE, E) / h, np.matmul(_BEND[None], E) / h**2

    @cached_property
    def _units(self) -> tuple[Array, Array, Array, Array]:
        """Limits, scale of the rates' rows over the rates (m - 2, 1, k), x to scale rows with, its
        bound (m - 2, 3)."""
        ends = [
            bernstein.raised(bernstein.linear(f[1:-2], f[2:-1]), 2)
            for f in (self.reference, self.bound)
        ]
        factor = np.sqrt(ends[0])[..., None] / self.outputs.rate[1:-1, None]
        return self.outputs.limit[1:-1, None], factor, ends[0], ends[1]

    def slacks(self, z: Array) -> Array:
        """How far the motion is from every limit, in units of the limits; shape (rows,)."""
        return np.concatenate([self.rows(z, slopes=False)[0].ravel(), self.end_rows(z)[0].ravel()])

    def rows(self, z: Array, slopes: bool = True) -> tuple[Array, Array]:
        """Slacks of the inner cells (m - 2, K), and their derivatives by local unknowns (m - 2, K,
        3)."""
        m = self.size
        state = self._state(z)
        slack = np.concatenate([f.reshape(m, -1) for f in self._slacks(state)], axis=1)
        if not slopes:
            return slack, np.empty(0)
        found = self._slack_slopes(state)
        return slack, np.concatenate([f.reshape(m, -1, 3) for f in found], axis=1)

    def _state(self, z: Array) -> _State:
        """The motion at the three places of every inner cell."""
        N, D, U = self._motion
        local = z[self.spline.place][..., None]
        x = np.matmul(N, local)
        # a start may lie outside: what is not a number counts as no slack
        with np.errstate(invalid="ignore"):
            root = np.sqrt(x)
        u = np.matmul(D, local)
        _, _, e, _, _, _, _, de, _, _ = self._coefficients
        reference = self._units[2]
        return _State(
            x=x,
            u=u,
            bend=np.matmul(U, local),
            root=root,
            bernstein=self.spline.bernstein(z),
            viscous=(e * u + de * x) / root,
            spare=self.keep[1][1:-1, None] * np.sqrt(reference)[..., None] / root,
        )

    def _slacks(self, state: _State) -> list[Array]:
        """Values from above and below, rates from above and below, speed, positive control
        points."""
        a, b, e, c_high, c_low, da, db, _, dc_high, dc_low = self._coefficients
        limit, factor, reference, bound = self._units
        kept = self.keep[0][1:-1, None]
        bez = state.bernstein
        slowest = np.concatenate([[0.0], bez.min(axis=1), [0.0]])
        bottom, top = self.outputs.dry_friction(slowest[:, None])
        y = a * state.u + b * state.x + e * state.root
        change = (da + 2 * b) * state.u + a * state.bend + db * state.x + state.viscous
        return [
            kept - (y + c_high + top[1:-1, None]) / limit,
            kept + (y + c_low + bottom[1:-1, None]) / limit,
            state.spare - factor * (change + dc_high),
            state.spare + factor * (change + dc_low),
            1 - bez / bound,
            bez[:, 1:2] / reference[:, 1:2],
        ]

    def _slack_slopes(self, state: _State) -> list[Array]:
        """Derivatives of `_slacks` by the three local unknowns; how dry friction falls with the
        speed is left out."""
        a, b, e, _, _, da, db, de, _, _ = self._coefficients
        limit, factor, reference, bound = self._units
        N, D, U = (f[:, :, None] for f in self._motion)
        x = state.x
        root = state.root
        value_by_u = a / limit
        value_by_x = (b + e / (2 * root)) / limit
        value = value_by_u[..., None] * D + value_by_x[..., None] * N
        rate_by_u = factor * (da + 2 * b + e / root)
        rate_by_bend = factor * a
        rate_by_x = factor * (db + de / root - state.viscous / (2 * x))
        rate = rate_by_u[..., None] * D + rate_by_bend[..., None] * U
        rate += rate_by_x[..., None] * N
        spare = (-state.spare / (2 * x))[..., None] * N
        E = self.spline.to_bernstein
        return [
            -value,
            value,
            spare - rate,
            spare + rate,
            -E / bound[..., None],
            E[:, 1:2] / reference[:, 1:2, None],
        ]

    def curvature(self, z: Array, multipliers: Array) -> Array:
        """Upper bands of what the bend of rate / sqrt(x) takes from the Hessian, for multipliers of
        the inner rows."""
        m = self.size
        count = 3 * self.outputs.count
        reference = self._units[2]
        x = self.spline.bernstein(z) @ _VALUE.T
        both = multipliers[:, 2 * count : 3 * count] + multipliers[:, 3 * count : 4 * count]
        spare = self.keep[1][1:-1, None] * np.sqrt(reference / x)[..., None]
        return self.spline.banded(
            squared(self._motion[0], 0.75 / x**2 * (both.reshape(m, 3, -1) * spare).sum(axis=-1))
        )

    # ---- constraints of the end cells

    def end_rows(self, z: Array) -> tuple[Array, Array]:
        """Slacks of the two end cells (2, K) and their derivatives by the first and the last
        unknown.

        In them u lies between 0 and u_1, x between 0 and x_1, du/dt is constant: every term is
        taken at its largest.
        """
        bottom, top = self.outputs.dry_friction(np.zeros((1, 1)))
        slacks = []
        slopes = []
        for cell, sign, x, near in ((0, 1.0, z[0], 1), (-1, -1.0, z[-1], -2)):
            above = self._end_value(cell, sign, x, 1.0, top[cell])
            below = self._end_value(cell, sign, x, -1.0, bottom[cell])
            rate = self._end_rate(cell, x, near)
            found = (above, below, rate)
            slacks.append(np.concatenate([slack for slack, _ in found]))
            slopes.append(np.concatenate([slope for _, slope in found]))
        return np.stack(slacks), np.stack(slopes)

    def _end_value(
        self, cell: int, sign: float, x: float, side: float, dry: Array
    ) -> tuple[Array, Array]:
        """Slack of side times the outputs in an end cell, and its derivative by x_1, each (k,).

        Args:
            cell: 0 or -1.
            sign: of u there.
            x: at the inner end of the cell.
            side: 1 above, -1 below.
            dry: friction at its worst, shape (k,).
        """
        c = self.outputs
        limit = c.limit[cell]
        u_over_x = 2 / (3 * c.h[cell])
        r = np.sqrt(x)
        hold = c.c_high[cell] if side > 0 else -c.c_low[cell]
        pushing_a = np.maximum((side * sign * c.a[cell]).max(axis=0), 0)
        pushing_b = np.maximum((side * c.b[cell]).max(axis=0), 0)
        linear = u_over_x * pushing_a + pushing_b
        root = np.maximum((side * c.e[cell]).max(axis=0), 0)
        y = hold.max(axis=0) + side * dry + linear * x + root * r
        return self.keep[0][cell] - y / limit, -(linear + root / (2 * r)) / limit

    def _end_rate(self, cell: int, x: float, near: int) -> tuple[Array, Array]:
        """Slack of the outputs' rates in an end cell, and its derivative by x_1, each (k,)."""
        c = self.outputs
        h = c.h[cell]
        u_over_x = 2 / (3 * h)
        r = np.sqrt(x)
        da, db, de, dc = (
            np.abs(2 / h * np.diff(f[cell], axis=0)).max(axis=0) for f in (c.a, c.b, c.e, c.c_high)
        )
        a, b, e = (np.abs(f[cell]).max(axis=0) for f in (c.a, c.b, c.e))
        linear = (da + 2 * b) * u_over_x + a * 2 / (9 * h**2) + db
        root = e * u_over_x + de
        scale = np.sqrt(self.reference[near])
        factor = scale / c.rate[cell]
        kept = self.keep[1][cell] * scale
        slack = kept / r - factor * (linear * x + root * r + dc)
        slope = -kept / (2 * r * x) - factor * (linear + root / (2 * r))
        return slack, slope


def squared(rows: Array, weights: Array) -> Array:
    """Sum over rows (m, r, 3) of weight (m, r) times the row's square, shape (m, 3, 3)."""
    return np.asarray(np.matmul(np.swapaxes(rows * weights[..., None], 1, 2), rows))
