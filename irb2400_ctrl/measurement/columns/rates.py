"""Which columns are the rates of which, by their numbers alone."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from irb2400_ctrl.arrays import Array, Mask

MOST_ROWS = 20_000
"""that are looked at"""
WIDTH = 8
"""rows over which changes are taken"""
GOES_WITH = 0.9
"""correlation of a change and its rate"""
ALIKE = 1.5
"""most that the ratios of joints differ by: of a speed they are one, of friction not"""
STILL = 1e-3
"""travel of a joint that is at rest"""
LEAST = 3
"""joints that must move"""


class Rates(NamedTuple):
    """Of columns, over some rows.

    Args:
        changes: of each; sums: of each; moves: whether it does.
    """

    changes: Array
    sums: Array
    moves: Mask


def rates(table: Array) -> Rates:
    """Of the columns of a table, (rows, k)."""
    total = np.cumsum(table, axis=0)
    moves = np.ptp(table, axis=0) > STILL
    return Rates(table[WIDTH:] - table[:-WIDTH], total[WIDTH:] - total[:-WIDTH], moves)


def correlation(of: Rates) -> Array:
    """Of the changes of each column with the sums of each, shape (k, k); 0 where one is still."""
    a = (of.changes - of.changes.mean(axis=0)) * of.moves
    b = (of.sums - of.sums.mean(axis=0)) * of.moves
    size = np.outer(np.linalg.norm(a, axis=0), np.linalg.norm(b, axis=0))
    return np.asarray(a.T @ b / np.where(size > 0.0, size, np.inf))
