"""The two passes over the grid of a path, as machine code (`two_pass.c`)."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.machine_code.own_library import own_library
from irb2400_ctrl.planners.timing.two_pass.interpreted import Passed, interpreted_two_pass


@cache
def _library() -> ctypes.CDLL | None:
    library = own_library(__package__, "two_pass.c")
    if library is not None:
        library.two_pass.restype = ctypes.c_int64
    return library


def two_pass(constraints: Array, h: Array, low: Array, high: Array) -> Passed:
    """Largest x on a grid of m cells.

    Args:
        constraints: (p, q, r) of p u + q x_i <= r on each cell, shape (m, k, 3).
        h: lengths of the cells [m], shape (m,).
        low, high: bounds of x at the grid points, shape (m + 1,).
    """
    library = _library()
    if library is None:
        return interpreted_two_pass(constraints, h, low, high)
    m, k = constraints.shape[:2]
    table = np.ascontiguousarray(constraints)
    inputs = [np.ascontiguousarray(v, dtype=float) for v in (h, low, high)]
    scratch = np.empty((k + 2, 3))
    outputs = [np.zeros(m + 1) for _ in range(3)]
    pointers = [ctypes.c_void_p(v.ctypes.data) for v in (table, *inputs, scratch, *outputs)]
    code = library.two_pass(ctypes.c_int64(m), ctypes.c_int64(k), *pointers)
    infeasible = None if code == m + 1 else int(code if code >= 0 else -1 - code)
    return Passed(outputs[2], infeasible, outputs[0], outputs[1])
