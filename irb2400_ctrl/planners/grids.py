"""Grids along a path, cut more finely."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Integers


def counted(counts: Integers) -> Integers:
    """0, 1, … for each of the counts, one after another."""
    return np.asarray(np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts))


def divided(s: Array, parts: Integers) -> Array:
    """A grid with every cell cut into its number of equal parts."""
    return np.append(cut(np.stack([s[:-1], s[1:]]), parts)[0], s[-1])


def cut(cells: Array, parts: Integers) -> Array:
    """Start and end (2, m) of cells cut into equal parts, the last of which ends exactly where the
    cell does."""
    number = counted(parts)
    start = np.repeat(cells[0], parts)
    width = np.repeat((cells[1] - cells[0]) / parts, parts)
    last = number + 1 == np.repeat(parts, parts)
    end = np.where(last, np.repeat(cells[1], parts), start + (number + 1) * width)
    return np.stack([start + number * width, end])
