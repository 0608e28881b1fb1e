"""The two passes over the grid of a path, as machine code (`two_pass.c`)."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache
from importlib import resources

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.toolchain import build_shared


@dataclass(frozen=True)
class Passed:
    """Result of the passes."""

    x: Array
    """sdot^2 at the grid points, shape (m + 1,); meaningless unless all cells are feasible"""
    infeasible_cell: int | None
    """cell at which no x is left, None on success"""
    low: Array
    high: Array
    """interval of x from which the end can be reached, shape (m + 1,)"""


@cache
def _library() -> ctypes.CDLL:
    source = (resources.files(__package__) / "two_pass.c").read_text(encoding="utf-8")
    library = ctypes.CDLL(str(build_shared(source)))
    library.two_pass.restype = ctypes.c_int64
    return library


def two_pass(constraints: Array, h: Array, low: Array, high: Array) -> Passed:
    """Largest x on a grid of m cells.

    Args:
        constraints: (p, q, r) of p u + q x_i <= r on each cell, shape (m, k, 3).
        h: lengths of the cells [m], shape (m,).
        low, high: bounds of x at the grid points, shape (m + 1,).
    """
    m, k = constraints.shape[:2]
    table = np.ascontiguousarray(constraints)
    inputs = [np.ascontiguousarray(v, dtype=float) for v in (h, low, high)]
    scratch = np.empty((k + 2, 3))
    outputs = [np.zeros(m + 1) for _ in range(3)]
    pointers = [ctypes.c_void_p(v.ctypes.data) for v in (table, *inputs, scratch, *outputs)]
    code = _library().two_pass(ctypes.c_int64(m), ctypes.c_int64(k), *pointers)
    infeasible = None if code == m + 1 else int(code if code >= 0 else -1 - code)
    return Passed(outputs[2], infeasible, outputs[0], outputs[1])
