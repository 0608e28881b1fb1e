"""The torque rows of `torque_constraints` as machine code (`torque_rows.c`)."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.machine_code.own_library import own_library
from irb2400_ctrl.planners.enclosure.cells import Cells


@cache
def _library() -> ctypes.CDLL | None:
    return own_library(__package__, "torque_rows.c")


def has_machine_code() -> bool:
    """Whether there is a C compiler, or was one."""
    return _library() is not None


def write_torque_rows(
    table: Array,
    cells: Cells,
    at: tuple[Array, Array],
    dry: tuple[Array, Array],
    rest: Array,
    held: Array,
    limit: tuple[Array, float],
) -> None:
    """Write the first 8 n rows of every cell.

    Args:
        table: constraints of the cells, C contiguous, shape (m, k, 3) with k >= 8 n.
        cells: without effects beside the regular form.
        at: where the tangents touch and how far the chords go, x (m,) each.
        dry: least and largest dry friction [Nm], each (m, n).
        rest: what the parabolas may miss [Nm], shape (m, n).
        held: part of each limit to hold back [Nm], above and below, shape (m, 2, n).
        limit: of the torque (n,) [Nm], and which share of it is used.
    """
    library = _library()
    assert library is not None
    assert table.flags.c_contiguous
    m, rows, _ = table.shape
    n = len(limit[0])
    bottom, top = dry
    inputs = (cells.a, cells.b, cells.e, cells.c_low, cells.c_high, cells.h, *at, top, bottom, rest)
    arrays = [np.ascontiguousarray(v, dtype=float) for v in (*inputs, held, *limit)]
    pointers = [ctypes.c_void_p(v.ctypes.data) for v in (*arrays, table)]
    library.torque_rows(ctypes.c_int64(m), ctypes.c_int64(n), ctypes.c_int64(rows), *pointers)
