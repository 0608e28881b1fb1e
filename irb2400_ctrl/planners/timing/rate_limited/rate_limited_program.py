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

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.timing.rate_limited import cell_rows
from irb2400_ctrl.planners.timing.rate_limited.cell_rows import RowsOfCells, Sums
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

    def duration(self, z: Array) -> float:
        """Duration [s]; not a number where the motion stands still."""
        h = self.outputs.h
        # a trial may lie outside
        with np.errstate(invalid="ignore", divide="ignore"):
            inner = float((h[1:-1, None] * _WEIGHTS / self._at_nodes(z)).sum())
            return inner + float(3 * h[0] / np.sqrt(z[0]) + 3 * h[-1] / np.sqrt(z[-1]))

    def duration_slopes(self, z: Array) -> tuple[Array, Array]:
        """Gradient and Hessian (upper bands) of the duration."""
        h = self.outputs.h
        root = self._at_nodes(z)
        once = h[1:-1, None] * _WEIGHTS / root**3
        gradient = self.spline.gather(np.matmul(-once[:, None] / 2, self._gauss)[:, 0])
        H = self.spline.banded(squared(self._gauss, 0.75 * once / root**2))
        for end in (0, -1):
            gradient[end] -= 1.5 * h[end] / z[end] ** 1.5
            H[2, end] += 2.25 * h[end] / z[end] ** 2.5
        return gradient, H

    def _at_nodes(self, z: Array) -> Array:
        """sdot at the nodes of Gauss's rule in the inner cells, shape (m - 2, 3)."""
        return np.asarray(np.sqrt(self.spline.bernstein(z) @ _GAUSS.T))

    @cached_property
    def _gauss(self) -> Array:
        return np.asarray(np.matmul(_GAUSS, self.spline.to_bernstein))

    # ---- constraints: rows of the inner cells, then those of the end cells

    @cached_property
    def inner(self) -> RowsOfCells:
        """The rows of the inner cells."""
        c = self.outputs
        reference, bound = (
            bernstein.raised(bernstein.linear(f[1:-2], f[2:-1]), 2)
            for f in (self.reference, self.bound)
        )
        E = self.spline.to_bernstein
        h = c.h[1:-1, None, None]
        motion = (np.matmul(_VALUE, E), np.matmul(_SLOPE, E) / h, np.matmul(_BEND[None], E) / h**2)
        # speed, and positive control points
        linear = (-E / bound[..., None], E[:, 1:2] / reference[:, 1:2, None])
        return RowsOfCells(
            h=c.h[1:-1],
            parabolas=np.stack([_cells_last(f[1:-1]) for f in (c.a, c.b, c.e, c.c_high, c.c_low)]),
            per_limit=_cells_last(1 / c.limit[1:-1]),
            per_rate=_cells_last(1 / c.rate[1:-1]),
            kept=np.stack([_cells_last(f[1:-1]) for f in self.keep]),
            scale=_cells_last(np.sqrt(reference)),
            motion=np.ascontiguousarray(np.concatenate(motion, axis=1).transpose(1, 2, 0)),
            linear=np.ascontiguousarray(np.concatenate(linear, axis=1).transpose(1, 2, 0)),
            offset=np.array([1.0, 1.0, 1.0, 0.0]),
        )

    @property
    def _inner_shape(self) -> tuple[int, int]:
        return 12 * self.outputs.count + 4, self.size

    def _split(self, rows: Array) -> tuple[Array, Array]:
        """Numbers of all rows as those of the inner cells (12 k + 4, m - 2) and of the ends
        (2, 3 k)."""
        count, m = self._inner_shape
        return rows[: count * m].reshape(count, m), rows[count * m :].reshape(2, -1)

    def slacks(self, z: Array) -> tuple[Array, float]:
        """How far the motion is from every limit, in units of the limits, shape (rows,), and the
        sum of their logarithms; the second is -inf where a limit is not kept."""
        count, m = self._inner_shape
        found = np.full(count * m + 6 * self.outputs.count, -np.inf)
        inner, ends = self._split(found)
        coefficients = self.spline.bernstein(z)
        if not (coefficients[:, [0, 2]].min() > 0 and (coefficients @ _VALUE[1]).min() > 0):
            return found, -np.inf
        slowest = np.concatenate([[0.0], coefficients.min(axis=1), [0.0]])
        bottom, top = self.outputs.dry_friction(slowest[:, None])
        least = _cells_last(bottom[1:-1])
        most = _cells_last(top[1:-1])
        product = cell_rows.slacks(self.inner, _padded(z), least, most, inner)
        ends[...] = self.end_rows(z)[0]
        if not found.min() > 0:
            return found, -np.inf
        return found, float(np.log(product).sum() + np.log(ends).sum())

    def along(self, z: Array, dz: Array, slack: Array) -> Array:
        """Change of the slacks in a direction, to first order, over the slacks, shape (rows,)."""
        found = np.empty_like(slack)
        inner, ends = self._split(found)
        own, own_ends = self._split(slack)
        cell_rows.along(self.inner, _padded(z), _padded(dz), own, inner)
        ends[...] = self.end_rows(z)[1] * dz[[0, -1], None] / own_ends
        return found

    def sums(
        self, z: Array, slack: Array, multipliers: Array, mu: float
    ) -> tuple[Array, Array, Array, Array]:
        """Slopes of the slacks times mu / slack, and times the multipliers, each (m - 2,); times
        multipliers / slack times the slopes, and what the bend of rate / sqrt(x) takes from the
        Hessian, upper bands of each."""
        own, own_ends = self._split(slack)
        by, by_ends = self._split(multipliers)
        found: Sums = cell_rows.sums(self.inner, _padded(z), own, by, mu)
        slopes = self.end_rows(z)[1]
        pulled = [self.spline.gather(f) for f in found.pulled]
        for one, weight in zip(pulled, (mu / own_ends, by_ends), strict=True):
            one[[0, -1]] += (weight * slopes).sum(axis=1)
        squares, bend = (self.spline.banded(f) for f in found.squares)
        squares[2, [0, -1]] += (by_ends / own_ends * slopes**2).sum(axis=1)
        return pulled[0], pulled[1], squares, bend

    def worst(self, z: Array) -> tuple[int, int, float]:
        """Cell and row (0 … 12 k + 3) of the smallest slack in the inner cells, and the slack."""
        slack = self._split(self.slacks(z)[0])[0]
        row, cell = np.unravel_index(int(np.argmin(slack)), slack.shape)
        return int(cell) + 1, int(row), float(slack[row, cell])

    # ---- constraints of the end cells

    def end_rows(self, z: Array) -> tuple[Array, Array]:
        """Slacks of the two end cells (2, K) and their derivatives by the first and the last
        unknown.

        In them u lies between 0 and u_1, x between 0 and x_1, du/dt is constant: every term is
        taken at its largest.
        """
        return self._end_rows_at(float(z[0]), float(z[-1]))

    @cached_property
    def _end_rows_at(self) -> Callable[[float, float], tuple[Array, Array]]:
        """The same, kept: an iteration asks three times for those of one motion."""
        return lru_cache(maxsize=2)(self._end_rows_of)

    def _end_rows_of(self, first: float, last: float) -> tuple[Array, Array]:
        bottom, top = self._end_friction
        slacks = []
        slopes = []
        for cell, sign, x, near in ((0, 1.0, first, 1), (-1, -1.0, last, -2)):
            above = self._end_value(cell, sign, x, 1.0, top[cell])
            below = self._end_value(cell, sign, x, -1.0, bottom[cell])
            rate = self._end_rate(cell, x, near)
            found = (above, below, rate)
            slacks.append(np.concatenate([slack for slack, _ in found]))
            slopes.append(np.concatenate([slope for _, slope in found]))
        return np.stack(slacks), np.stack(slopes)

    @cached_property
    def _end_friction(self) -> tuple[Array, Array]:
        return self.outputs.dry_friction(np.zeros((1, 1)))

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


def _cells_last(f: Array) -> Array:
    """The same array with its first axis last, in order."""
    return np.ascontiguousarray(f.T if f.ndim == 2 else f.transpose(2, 1, 0))


def _padded(z: Array) -> Array:
    """The control points, the first and the last twice: three in a row are those of a cell."""
    return np.concatenate([z[:1], z, z[-1:]])
