"""`RateLimitedProgram`: the shortest duration under limits of torque and torque rate, as a program
with few neighbours.

Unknown are the control points z of x(s) = sdot^2, a quadratic B-spline on the inner cells: u = x'/2
is continuous and linear in each cell. In the end cells s = h (t / T)^3 (`RateLimitedLaw`), so that
x_1 = 3 h u_1 / 2 there. With the outputs y = a u + b x + e sqrt(x) + c + dry friction of
`ConstrainedOutputs`, at both ends and the middle of every cell,

    |y| <= limit,        |(a' + 2 b) u + a u' + b' x + c' + (e u + e' x) / sqrt(x)| <= rate /
    sqrt(x).

The left side of the second is linear in z but for the small e, and the right one convex: its
tangent is a smaller limit. A slow enough motion is within all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import (
    ConstrainedOutputs,
    Integers,
)

Array = npt.NDArray[np.float64]

# where the rows stand in a cell: Bernstein polynomials there, their slopes, and their bend
_AT = np.array([0.0, 0.5, 1.0])
_VALUE = np.stack([(1 - _AT) ** 2, 2 * _AT * (1 - _AT), _AT**2], axis=1)
_SLOPE = np.stack([-(1 - _AT), 1 - 2 * _AT, _AT], axis=1)
_BEND = np.array([1.0, -2.0, 1.0])
# Gauss's rule with three points on [0, 1]
_NODES = 0.5 + np.sqrt(0.15) * np.array([-1.0, 0.0, 1.0])
_GAUSS = np.stack([(1 - _NODES) ** 2, 2 * _NODES * (1 - _NODES), _NODES**2], axis=1)
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

    # ---- from unknowns to Bernstein coefficients of x

    @cached_property
    def place(self) -> Integers:
        """Unknowns that the three control points of each inner cell come from, shape (m - 2, 3)."""
        point = np.arange(self.size)[:, None] + np.arange(3)
        return np.asarray(np.clip(point - 1, 0, self.size - 1))

    @cached_property
    def to_bernstein(self) -> Array:
        """Bernstein coefficients of x in each inner cell from its three unknowns, shape (m - 2, 3,
        3)."""
        all_h = self.outputs.h
        h = all_h[1:-1]
        before = np.append(0.0, h[:-1])
        after = np.append(h[1:], 0.0)
        E = np.zeros((self.size, 3, 3))
        E[:, 0, 0] = h / (before + h)
        E[:, 0, 1] = before / (before + h)
        E[:, 1, 1] = 1.0
        E[:, 2, 1] = after / (h + after)
        E[:, 2, 2] = h / (h + after)
        # the second control point is a multiple of the first, at either end: x_1 = 3 h u_1 / 2
        first = 1 + 2 * h[0] / (3 * all_h[0])
        last = 1 + 2 * h[-1] / (3 * all_h[-1])
        E[0, :, 1] *= first
        E[1, :, 0] *= first
        E[-1, :, 1] *= last
        E[-2, :, 2] *= last
        return E

    def bernstein(self, z: Array) -> Array:
        """Bernstein coefficients of x in the inner cells, shape (m - 2, 3)."""
        return np.asarray(np.matmul(self.to_bernstein, z[self.place][..., None])[..., 0])

    def gather(self, gradient: Array) -> Array:
        """From derivatives by local unknowns (m - 2, 3) to those by all."""
        return np.asarray(np.bincount(self.place.ravel(), gradient.ravel(), self.size), dtype=float)

    def banded(self, blocks: Array) -> Array:
        """From Hessians by local unknowns (m - 2, 3, 3) to the upper bands of all, shape (3, m -
        2)."""
        flat, upper = self._bands
        return np.asarray(np.bincount(flat, blocks[upper], 3 * self.size), dtype=float).reshape(
            3, self.size
        )

    @cached_property
    def _bands(self) -> tuple[Integers, npt.NDArray[np.bool_]]:
        shape = (self.size, 3, 3)
        rows = np.broadcast_to(self.place[:, :, None], shape)
        columns = np.broadcast_to(self.place[:, None, :], shape)
        upper = columns >= rows
        return ((2 + rows - columns) * self.size + columns)[upper], upper

    # ---- objective

    def duration(self, z: Array) -> tuple[float, Array, Array]:
        """Duration [s], its gradient and its Hessian (upper bands)."""
        h = self.outputs.h
        weight = h[1:-1, None] * _WEIGHTS
        root = np.sqrt(self.bernstein(z) @ _GAUSS.T)
        value = float((weight / root).sum()) + 3 * h[0] / np.sqrt(z[0]) + 3 * h[-1] / np.sqrt(z[-1])
        gradient = self.gather(np.matmul((-weight / (2 * root**3))[:, None], self._gauss)[:, 0])
        H = self.banded(squared(self._gauss, 0.75 * weight / root**5))
        for end in (0, -1):
            gradient[end] -= 1.5 * h[end] / z[end] ** 1.5
            H[2, end] += 2.25 * h[end] / z[end] ** 2.5
        return value, gradient, H

    @cached_property
    def _gauss(self) -> Array:
        return np.asarray(np.matmul(_GAUSS, self.to_bernstein))

    # ---- rows of the inner cells

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
        E = self.to_bernstein
        h = self.outputs.h[1:-1, None, None]
        return np.matmul(_VALUE, E), np.matmul(_SLOPE, E) / h, np.matmul(_BEND[None], E) / h**2

    @cached_property
    def _units(self) -> tuple[Array, Array, Array, Array]:
        """Limits, scale of the rates' rows over the rates (m - 2, 1, k), x to scale rows with, its
        bound (m - 2, 3)."""
        ends = []
        for f in (self.reference, self.bound):
            first = f[1:-2]
            last = f[2:-1]
            ends.append(np.stack([first, (first + last) / 2, last], axis=1))
        factor = np.sqrt(ends[0])[..., None] / self.outputs.rate[1:-1, None]
        return self.outputs.limit[1:-1, None], factor, ends[0], ends[1]

    def slacks(self, z: Array) -> Array:
        """How far the motion is from every limit, in units of the limits; shape (rows,)."""
        return np.concatenate([self.rows(z, slopes=False)[0].ravel(), self.end_rows(z)[0].ravel()])

    def rows(self, z: Array, slopes: bool = True) -> tuple[Array, Array]:
        """Slacks of the inner cells (m - 2, K), and their derivatives by local unknowns (m - 2, K,
        3)."""
        a, b, e, c_high, c_low, da, db, de, dc_high, dc_low = self._coefficients
        limit, factor, reference, bound = self._units
        N, D, U = self._motion
        local = z[self.place][..., None]
        x = np.matmul(N, local)
        u = np.matmul(D, local)
        bend = np.matmul(U, local)
        bez = self.bernstein(z)
        r = np.sqrt(x)
        value, rate = (k[1:-1, None] for k in self.keep)
        top, bottom = self.outputs.dry_friction(
            np.concatenate([[0.0], bez.min(axis=1), [0.0]])[:, None]
        )
        y = a * u + b * x + e * r
        viscous = (e * u + de * x) / r
        spare = rate * np.sqrt(reference)[..., None] / r
        change = (da + 2 * b) * u + a * bend + db * x + viscous
        found = [
            value - (y + c_high + top[1:-1, None]) / limit,
            value + (y + c_low + bottom[1:-1, None]) / limit,
            spare - factor * (change + dc_high),
            spare + factor * (change + dc_low),
            1 - bez / bound,
            # control points are positive
            bez[:, 1:2] / reference[:, 1:2],
        ]
        m = self.size
        slack = np.concatenate([f.reshape(m, -1) for f in found], axis=1)
        if not slopes:
            return slack, np.empty(0)
        N = N[:, :, None]
        D = D[:, :, None]
        U = U[:, :, None]
        by_z = (a / limit)[..., None] * D + ((b + e / (2 * r)) / limit)[..., None] * N
        turning = (factor * (da + 2 * b + e / r))[..., None] * D + (factor * a)[..., None] * U
        turning += (factor * (db + de / r - viscous / (2 * x)))[..., None] * N
        falling = (-spare / (2 * x))[..., None] * N
        found = [-by_z, by_z, falling - turning, falling + turning]
        E = self.to_bernstein
        found += [-E / bound[..., None], E[:, 1:2] / reference[:, 1:2, None]]
        return slack, np.concatenate([f.reshape(m, -1, 3) for f in found], axis=1)

    def curvature(self, z: Array, multipliers: Array) -> Array:
        """Upper bands of what the bend of rate / sqrt(x) takes from the Hessian, for multipliers of
        the inner rows."""
        m = self.size
        count = 3 * self.outputs.count
        reference = self._units[2]
        x = self.bernstein(z) @ _VALUE.T
        both = multipliers[:, 2 * count : 3 * count] + multipliers[:, 3 * count : 4 * count]
        spare = self.keep[1][1:-1, None] * np.sqrt(reference / x)[..., None]
        return self.banded(
            squared(self._motion[0], 0.75 / x**2 * (both.reshape(m, 3, -1) * spare).sum(axis=-1))
        )

    # ---- rows of the end cells

    def end_rows(self, z: Array) -> tuple[Array, Array]:
        """Slacks of the two end cells (2, K) and their derivatives by the first and the last
        unknown.

        In them u lies between 0 and u_1, x between 0 and x_1, du/dt is constant: every term is
        taken at its largest.
        """
        c = self.outputs
        top, bottom = c.dry_friction(np.zeros((1, 1)))
        found = []
        slope = []
        for cell, sign, x, near in ((0, 1.0, z[0], 1), (-1, -1.0, z[-1], -2)):
            h = c.h[cell]
            r = np.sqrt(x)
            kappa = 2 / (3 * h)
            a = c.a[cell]
            b = c.b[cell]
            e = c.e[cell]
            rows = []
            by_x = []
            for side, dry, hold in (
                (1.0, top[cell], c.c_high[cell]),
                (-1.0, bottom[cell], c.c_low[cell]),
            ):
                linear = kappa * np.maximum((side * sign * a).max(axis=0), 0) + np.maximum(
                    (side * b).max(axis=0), 0
                )
                root = np.maximum((side * e).max(axis=0), 0)
                y = (side * hold).max(axis=0) + side * dry + linear * x + root * r
                rows.append(self.keep[0][cell] - y / c.limit[cell])
                by_x.append(-(linear + root / (2 * r)) / c.limit[cell])
            da, db, de, dc = (
                np.abs(2 / h * np.diff(f[cell], axis=0)).max(axis=0)
                for f in (c.a, c.b, c.e, c.c_high)
            )
            a, b, e = (np.abs(f).max(axis=0) for f in (a, b, e))
            linear = (da + 2 * b) * kappa + a * 2 / (9 * h**2) + db
            root = e * kappa + de
            scale = np.sqrt(self.reference[near])
            factor = scale / c.rate[cell]
            rows.append(self.keep[1][cell] * scale / r - factor * (linear * x + root * r + dc))
            by_x.append(
                -self.keep[1][cell] * scale / (2 * r * x) - factor * (linear + root / (2 * r))
            )
            found.append(np.concatenate(rows))
            slope.append(np.concatenate(by_x))
        return np.stack(found), np.stack(slope)


def squared(rows: Array, weights: Array) -> Array:
    """Sum over rows (m, r, 3) of weight (m, r) times the row's square, shape (m, 3, 3)."""
    return np.asarray(np.matmul(np.swapaxes(rows * weights[..., None], 1, 2), rows))
