"""The functions of `cell_rows.c` as machine code, or those of `interpreted`."""

from __future__ import annotations

import ctypes
from functools import cache, lru_cache

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.machine_code.own_library import own_library
from irb2400_ctrl.planners.timing.rate_limited.cell_rows import interpreted
from irb2400_ctrl.planners.timing.rate_limited.cell_rows.rows_of_cells import RowsOfCells, Sums


@cache
def _library() -> ctypes.CDLL | None:
    return own_library(__package__, "cell_rows.c")


_ARRAYS = (
    "h", "parabolas", "per_limit", "per_rate", "kept", "scale", "motion", "linear", "offset",
)  # fmt: skip


class _CellRows(ctypes.Structure):
    _fields_ = (
        ("m", ctypes.c_int64),
        ("k", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in _ARRAYS),
    )


@lru_cache(maxsize=4)
def _in_c(rows: RowsOfCells) -> _CellRows:
    """What C sees of the rows; kept with them, for an iteration asks three times."""
    arrays = (getattr(rows, name) for name in _ARRAYS)
    return _CellRows(rows.size, rows.count, *(_at(array) for array in arrays))


def _at(array: Array) -> ctypes.c_void_p:
    if not array.flags.c_contiguous or array.dtype != np.float64:
        raise ValueError(
            f"found an array {array.dtype}, {array.strides}; expected doubles in order"
        )
    return ctypes.c_void_p(array.ctypes.data)


def slacks(rows: RowsOfCells, z: Array, bottom: Array, top: Array, out: Array) -> Array:
    """How far a motion is from every limit, in units of the limits.

    Args:
        rows: the rows.
        z: positive unknowns, the first and the last twice, shape (m + 2,).
        bottom, top: least and largest dry friction, shape (k, m).
        out: the slacks, written, shape (12 k + 4, m).

    Returns:
        the products of the slacks of each output, and of the linear rows, shape (k + 1, m).
    """
    library = _library()
    if library is None:
        return interpreted.slacks(rows, z, bottom, top, out)
    product = np.empty((rows.count + 1, rows.size))
    given = (_at(v) for v in (z, bottom, top, out, product))
    library.slacks(ctypes.byref(_in_c(rows)), *given)
    return product


def along(rows: RowsOfCells, z: Array, dz: Array, slack: Array, out: Array) -> None:
    """Change of the slacks in a direction dz (m + 2,), to first order, over the slacks; written to
    `out` (12 k + 4, m)."""
    library = _library()
    if library is None:
        interpreted.along(rows, z, dz, slack, out)
        return
    library.along(ctypes.byref(_in_c(rows)), *(_at(v) for v in (z, dz, slack, out)))


def sums(rows: RowsOfCells, z: Array, slack: Array, multipliers: Array, mu: float) -> Sums:
    """What a step of Newton's method needs of the slopes, for a barrier mu."""
    library = _library()
    if library is None:
        return interpreted.sums(rows, z, slack, multipliers, mu)
    pulled = np.zeros((2, rows.size, 3))
    squares = np.zeros((2, rows.size, 3, 3))
    library.sums(
        ctypes.byref(_in_c(rows)),
        *(_at(v) for v in (z, slack, multipliers)),
        ctypes.c_double(mu),
        *(_at(v) for v in (pulled, squares)),
    )
    return Sums(pulled, squares)


def steepest(slack: Array, multipliers: Array, relative: Array, mu: float) -> tuple[float, float]:
    """Largest part of a slack, and of a multiplier, that the whole step takes; each (rows,)."""
    library = _library()
    if library is None:
        return interpreted.steepest(slack, multipliers, relative, mu)
    found = np.empty(2)
    library.steepest(
        ctypes.c_int64(slack.size),
        *(_at(v) for v in (slack, multipliers, relative)),
        ctypes.c_double(mu),
        _at(found),
    )
    return float(found[0]), float(found[1])


def updated(
    multipliers: Array,
    slack: Array,
    relative: Array,
    new_slack: Array,
    mu: float,
    step: float,
    spread: float,
) -> Array:
    """Multipliers after a part of a step, within a factor of mu over the new slacks."""
    library = _library()
    if library is None:
        return interpreted.updated(multipliers, slack, relative, new_slack, mu, step, spread)
    found = multipliers.copy()
    library.updated(
        ctypes.c_int64(slack.size),
        *(_at(v) for v in (slack, relative, new_slack)),
        *(ctypes.c_double(v) for v in (mu, step, spread)),
        _at(found),
    )
    return found
