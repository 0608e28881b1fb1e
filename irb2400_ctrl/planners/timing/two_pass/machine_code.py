"""The two passes over the grid of a path, as machine code (`two_pass.c`)."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from typing import Protocol

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.machine_code.own_library import own_library
from irb2400_ctrl.planners.timing.two_pass.interpreted import Passed, interpreted_two_pass


class Constraints(Protocol):
    """(p, q, r) of p u + q x_i <= r on each of m cells, of neighbouring ones at a time."""

    def __getitem__(self, of: slice, /) -> Array:
        """Of those cells, shape (cells, k, 3)."""


@cache
def _library() -> ctypes.CDLL | None:
    library = own_library(__package__, "two_pass.c")
    if library is not None:
        library.backward.restype = library.forward.restype = ctypes.c_int64
    return library


def two_pass(
    constraints: Constraints,
    h: Array,
    low: Array,
    high: Array,
    blocks: Sequence[slice] | None = None,
) -> Passed:
    """Largest x on a grid of m cells.

    Args:
        constraints: on the cells; an array of shape (m, k, 3), or what makes parts of it.
        h: lengths of the cells [m], shape (m,).
        low, high: bounds of x at the grid points, shape (m + 1,).
        blocks: cells whose constraints are asked for at once, once for each pass; default all.
    """
    library = _library()
    m = len(h)
    if library is None:
        return interpreted_two_pass(constraints[0:m], h, low, high)
    blocks = blocks or [slice(0, m)]
    # of a path that is one block they are made once
    only = constraints[blocks[0]] if len(blocks) == 1 else None
    h, low, high = (np.ascontiguousarray(v, dtype=float) for v in (h, low, high))
    x, reach_low, reach_high = (np.zeros(m + 1) for _ in range(3))
    reach_low[m] = low[m]
    reach_high[m] = high[m]
    for block in reversed(blocks):
        table = constraints[block] if only is None else only
        scratch = np.empty((table.shape[1] + 2, 3))
        arrays = (h, low, high, scratch, reach_low, reach_high)
        cell = _over(library.backward, block, table, *arrays)
        if cell >= 0:
            return Passed(x, cell, reach_low, reach_high)
    x[0] = reach_high[0]
    for block in blocks:
        table = constraints[block] if only is None else only
        cell = _over(library.forward, block, table, h, reach_low, reach_high, x)
        if cell >= 0:
            return Passed(x, cell, reach_low, reach_high)
    return Passed(x, None, reach_low, reach_high)


def _over(one_pass: Callable[..., int], block: slice, table: Array, *arrays: Array) -> int:
    """A pass over a block of cells; the cell that fails, or -1."""
    held = (np.ascontiguousarray(table), *arrays)
    ends = (ctypes.c_int64(v) for v in (block.start, block.stop, table.shape[1]))
    return one_pass(*ends, *(ctypes.c_void_p(v.ctypes.data) for v in held))
