"""Numbers and symbols through one door: a CasADi function called with numpy arrays, SX or MX."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, TypeVar, cast
from weakref import WeakKeyDictionary

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers
from irb2400_ctrl.symbolic import Walk
from irb2400_ctrl.symbolic.vectorised import OnArrays

_FEW = 256
"""states from which on every operation works on arrays of them: of a thousand in a half to a fifth
of CasADi's time"""
_PART = 1024
"""states of one such array, or of a map of CasADi's"""
_MAPS: WeakKeyDictionary[ca.Function, dict[int, ca.Function]] = WeakKeyDictionary()
_WALKS: WeakKeyDictionary[ca.Function, Walk[Any] | None] = WeakKeyDictionary()

# numpy in, numpy out; SX or MX in, the same out
Value = TypeVar("Value", npt.NDArray[np.float64], ca.SX, ca.MX)


def evaluate(
    function: ca.Function, *inputs: Value, constants: tuple[float, ...] = (), matrix: bool = False
) -> Value:
    """The function's first output for one state (width,) per input, or for m states (m, width).

    Args:
        function: its remaining inputs are scalars.
        inputs: one state each, shape (width,), or m of them, shape (m, width).
        constants: values of the remaining scalar inputs.
        matrix: one result keeps its two dimensions.

    Raises:
        InputError: a shape that does not fit.
    """
    if any(isinstance(value, ca.SX | ca.MX) for value in inputs):
        return cast(Value, _symbolic(function, inputs, constants))
    arrays: list[Any] = [numbers(function.name(), value) for value in inputs]
    many = max(array.ndim for array in arrays) == 2
    count = max((len(array) for array in arrays if array.ndim == 2), default=1)
    for position, array in enumerate(arrays):
        width = function.size1_in(position)
        if array.shape not in {(width,), (count, width)}:
            expected = f"({width},) or ({count if many else 'm'}, {width})"
            raise InputError(
                f"{function.name()}, argument {position + 1}: found shape {array.shape}, expected "
                f"{expected}"
            )
    if not many:
        return cast(Value, _one(function, [*arrays, *(np.array([c]) for c in constants)], matrix))
    columns = [np.broadcast_to(array, (count, array.shape[-1])) for array in arrays]
    columns += [np.full((count, 1), value) for value in constants]
    found: Any = _many(function, columns, count)
    return cast(Value, found if matrix else found[:, :, 0])


def _symbolic(function: ca.Function, inputs: tuple[Any, ...], constants: tuple[float, ...]) -> Any:
    try:
        return function(*inputs, *constants)
    except RuntimeError as error:
        found = ", ".join(str(getattr(value, "shape", value)) for value in inputs)
        wanted = ", ".join(str(function.size_in(k)) for k in range(len(inputs)))
        raise InputError(
            f"{function.name()}: found symbols of shapes {found}, expected {wanted}"
        ) from error


def _many(function: ca.Function, inputs: list[Any], count: int) -> Any:
    """m evaluations, shape (m, rows, columns)."""
    shape = function.sparsity_out(0)
    rows, columns = shape.shape
    places = columns * np.array(shape.row(), dtype=int) + np.array(shape.get_col(), dtype=int)
    result = np.zeros((count, rows * columns))
    walk = _walk(function) if count >= _FEW else None
    if walk is not None:
        _by_arrays(walk, inputs, places, result)
    elif shape.nnz():
        _by_casadi(function, inputs, places, result)
    return result.reshape(count, rows, columns)


def _by_arrays(walk: Walk[Any], inputs: list[Any], places: Any, result: Any) -> None:
    """Write the nonzeros into their places of the result, operation by operation."""
    turned = [np.ascontiguousarray(value.T, dtype=float) for value in inputs]
    for first in range(0, len(result), _PART):
        rows = slice(first, first + _PART)
        part = [value[:, rows] for value in turned]
        with np.errstate(all="ignore"):  # what is no number is the result, as CasADi has it
            found = walk(_elements(part))[0]
        # states side by side until all are there: single numbers far apart are slow to write
        values = np.zeros(result[rows].T.shape)
        for place, value in zip(places, found, strict=True):
            values[place] = value
        result[rows] = values.T


def _elements(arrays: list[Any]) -> Callable[[int, int], Any]:
    """(number of the input, number of the element in it) -> its value in every state."""
    return lambda i, k: arrays[i][k]


def _walk(function: ca.Function) -> Walk[Any] | None:
    """The function's operations on arrays, kept with it; None where numpy lacks one of them."""
    if function not in _WALKS:
        try:
            _WALKS[function] = Walk(function, OnArrays())
        except InputError:
            _WALKS[function] = None
    return _WALKS[function]


def _by_casadi(function: ca.Function, inputs: list[Any], places: Any, result: Any) -> None:
    """The same by CasADi, which maps the function over buffers, part by part, without matrices of
    its own, whose conversion takes longer than the model."""
    held = [np.ascontiguousarray(value, dtype=float) for value in inputs]
    for first, many in _parts(len(result)):
        values = np.zeros((many, len(places)))
        opened: Any = _map(function, many).buffer()
        buffer, trigger = opened
        for position, array in enumerate(held):
            buffer.set_arg(position, array[first : first + many].reshape(-1).data)
        buffer.set_res(0, values.reshape(-1).data)
        trigger()
        result[first : first + many, places] = values


def _parts(count: int) -> Iterator[tuple[int, int]]:
    """First row and number of rows of each part: whole ones, then powers of two, so that few maps
    serve any count."""
    first = 0
    while first < count:
        many = min(_PART, 1 << ((count - first).bit_length() - 1))
        yield first, many
        first += many


def _map(function: ca.Function, many: int) -> ca.Function:
    """The function for many states; kept with it, for making it takes longer than a pass through
    it: four times as long for a regressor."""
    maps = _MAPS.setdefault(function, {})
    if many not in maps:
        maps[many] = function.map(many)
    return maps[many]


def _one(function: ca.Function, inputs: list[Any], matrix: bool) -> Any:
    """One evaluation through CasADi's buffers: a tenth of the time of a call with arrays."""
    opened: Any = function.buffer()
    buffer, trigger = opened
    # the arrays must live until the call, and CasADi keeps matrices column by column
    held = [np.ascontiguousarray(value, dtype=float) for value in inputs]
    for position, array in enumerate(held):
        buffer.set_arg(position, array.data)
    result = np.zeros((function.size2_out(0), function.size1_out(0)))
    buffer.set_res(0, result.reshape(-1).data)
    trigger()
    return np.ascontiguousarray(result.T) if matrix else result.reshape(-1)
