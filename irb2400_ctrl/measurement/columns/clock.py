"""`Clock`: where a file holds its time, before its rows are read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array


@dataclass(frozen=True)
class Clock:
    """Where the rows of a table hold their time.

    Args:
        columns: one; or two, whole seconds and what is beyond them.
        scale: seconds a count; where rows are counted, a row.
        counted: the file has no time: rows are counted, and the column only tells how many.
        beyond: counts a second of the second column.
    """

    columns: tuple[str, ...]
    scale: float = 1.0
    counted: bool = False
    beyond: int = 10**9

    def seconds(self, columns: Mapping[str, Array], before: int, whole: float) -> Array:
        """Times of some rows [s], (m,).

        Args:
            columns: at least those of the clock, each (m,).
            before: how many rows stand before these in the file.
            whole: what is taken off a time in two columns [s]: counted from 1970, both in one
                number would lose the last digits.
        """
        first = columns[self.columns[0]]
        if self.counted:
            return np.asarray((before + np.arange(len(first))) * self.scale)
        if len(self.columns) == 1:
            return np.asarray(self.scale * first)
        return np.asarray((first - whole) + columns[self.columns[1]] / self.beyond)
