"""`RowsOfCells`: what the rows of a `RateLimitedProgram` in its inner cells are made of, and the
sums over them that a step of the interior point needs."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.arrays import Array


@dataclass(frozen=True, eq=False)
class RowsOfCells:
    """k outputs on m cells, the last axis of every array; contiguous.

    Rows (12 k + 4, m): of each output its value from above and below, its rate from above and
    below, each at both ends and the middle of the cell; then four rows that are linear in the
    unknowns. The unknowns of cell i are z_i, z_{i+1}, z_{i+2} of z (m + 2,).
    """

    h: Array
    """lengths of the cells [m], shape (m,)"""
    parabolas: Array
    """Bernstein coefficients of a, b, e, c_high, c_low, shape (5, k, 3, m)"""
    per_limit: Array
    per_rate: Array
    """1 over the limits, and over the rates, shape (k, m)"""
    kept: Array
    """parts of the limits, and of the rates, that may be used, shape (2, k, m)"""
    scale: Array
    """of the rates' rows: about sdot at the three places [m/s], shape (3, m)"""
    motion: Array
    """x at the three places, u there, and du/ds from the unknowns, shape (7, 3, m)"""
    linear: Array
    """slopes of the linear rows, shape (4, 3, m)"""
    offset: Array
    """and their constants, shape (4,)"""

    @property
    def count(self) -> int:
        """Number of outputs, k."""
        return int(self.per_limit.shape[0])

    @property
    def size(self) -> int:
        """Number of cells, m."""
        return len(self.h)


@dataclass(frozen=True)
class Sums:
    """Over the rows of each cell, by its three unknowns."""

    pulled: Array
    """slopes times mu / slack, and times the multipliers, shape (2, m, 3)"""
    squares: Array
    """slopes times multipliers / slack times slopes, and what the bend of rate / sqrt(x) takes from
    the Hessian, shape (2, m, 3, 3)"""
