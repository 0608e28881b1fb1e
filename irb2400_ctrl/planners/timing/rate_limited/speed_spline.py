"""`SpeedSpline`: x(s) = sdot^2 as a quadratic B-spline on the inner cells of a grid.

In the end cells s = h (t / T)^3 (`RateLimitedLaw`), so that x_1 = 3 h u_1 / 2 there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers


@dataclass(frozen=True, eq=False)
class SpeedSpline:
    """Bernstein coefficients of x from the control points, which are the unknowns."""

    h: Array
    """lengths of all m cells [m], shape (m,)"""

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return len(self.h) - 2

    @cached_property
    def place(self) -> Integers:
        """Unknowns that the three control points of each inner cell come from, shape (m - 2, 3)."""
        point = np.arange(self.size)[:, None] + np.arange(3)
        return np.asarray(np.clip(point - 1, 0, self.size - 1))

    @cached_property
    def to_bernstein(self) -> Array:
        """Bernstein coefficients of x in each inner cell from its three unknowns, shape (m - 2, 3,
        3)."""
        all_h = self.h
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
