"""`CompiledFunction`: a `casadi.Function` as machine code, with a thin door to numpy."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.codegen.host_library import (
    Math,
    Real,
    can_roll,
    host_source,
    what_text_follows_from,
)
from irb2400_ctrl.codegen.machine_code.build_cache import load_shared
from irb2400_ctrl.codegen.machine_code.interpreted import Interpreter, say_slow
from irb2400_ctrl.errors import InputError, ToolMissingError
from irb2400_ctrl.symbolic import as_sx
from irb2400_ctrl.typed import typed

Array = NDArray[Any]
Shape = tuple[int, int]


@typed
def compile_function(
    fn: ca.Function,
    *,
    real: Real = "double",
    math: Math = "own",
    fused: bool = False,
    lanes: bool = False,
) -> CompiledFunction:
    """Machine code of `fn`, made by this machine's C compiler or taken from the cache.

    Without a compiler the same calls go through CasADi's virtual machine, about thirty times
    slower; stderr says so once.

    Args:
        fn: any function that expands into scalar operations.
        real: precision of the computation.
        math: "own" carries sine, exponential … along (same bits on every machine; stated domains);
            "libm" calls the C library (wider domains, more functions).
        fused: allow fused multiply-add: about a fifth faster, last bits depend on the processor.
        lanes: `map` works on eight rows at once, with the same bits: about four times as fast where
            elementary functions are most of the work, and two to four times as long to compile.

    Raises:
        InputError: `fn` holds an operation that has no C form, or an unknown precision or math.
    """
    fn = as_sx(fn)
    source = partial(host_source, fn, real=real, math=math, lanes=lanes)
    made_of = what_text_follows_from(fn, real=real, math=math, lanes=lanes)
    library: ctypes.CDLL | Interpreter
    try:
        library = load_shared(source, fused=fused, straight=not lanes, made_of=made_of)
    except ToolMissingError as error:
        source()  # what has no C form is refused here as well
        say_slow(str(error))
        library = Interpreter(fn, np.dtype(np.float64 if real == "double" else np.float32))
    return CompiledFunction(
        name=fn.name(),
        real=real,
        input_names=tuple(fn.name_in()),
        output_names=tuple(fn.name_out()),
        input_shapes=tuple(fn.size_in(i) for i in range(fn.n_in())),
        output_shapes=tuple(fn.size_out(i) for i in range(fn.n_out())),
        _library=library,
    )


@dataclass(frozen=True)
class FunctionBuffers:
    """Fixed memory for one caller: write into `inputs`, call `run()`, read `outputs`; below a
    microsecond.

    The arrays are views of one block each; a matrix shows up in its own shape. Give each thread its
    own.
    """

    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    run: Callable[[], None]


@dataclass(frozen=True, eq=False)
class CompiledFunction:
    """Machine code of a function with inputs and outputs of fixed shape; made by
    `compile_function`."""

    name: str
    real: Real
    input_names: tuple[str, ...]
    output_names: tuple[str, ...]
    input_shapes: tuple[Shape, ...]
    output_shapes: tuple[Shape, ...]
    _library: ctypes.CDLL | Interpreter

    @property
    def dtype(self) -> np.dtype[Any]:
        """numpy's name of the precision."""
        return np.dtype(np.float64 if self.real == "double" else np.float32)

    def buffers(self) -> FunctionBuffers:
        """New fixed memory and the fastest way to call from Python."""
        block_in = np.zeros(sum(r * c for r, c in self.input_shapes), self.dtype)
        block_out = np.zeros(sum(r * c for r, c in self.output_shapes), self.dtype)
        run = partial(
            self._library.run,
            ctypes.c_void_p(block_in.ctypes.data),
            ctypes.c_void_p(block_out.ctypes.data),
        )
        inputs = _views(block_in, self.input_shapes)
        outputs = _views(block_out, self.output_shapes)
        return FunctionBuffers(inputs, outputs, run)

    def call(self, *arguments: ArrayLike) -> tuple[Array, ...]:
        """One evaluation; vectors come back with shape (k,), matrices with their own.

        Raises:
            InputError: wrong number of arguments, or one of the wrong size.
        """
        self._expect_count(arguments)
        memory = self.buffers()
        for i, (place, argument) in enumerate(zip(memory.inputs, arguments, strict=True)):
            given = np.asarray(argument, self.dtype)
            if given.size != place.size:
                raise self._wrong_shape(i, given.shape, f"{place.shape}")
            place[...] = given.reshape(place.shape)
        memory.run()
        return memory.outputs

    def map(self, *arguments: ArrayLike) -> tuple[Array, ...]:
        """Many evaluations, looped in C.

        Args:
            arguments: each (n, k) for an input of k elements (a matrix input: (n, rows, columns)),
                or one value of the input's own shape that holds for all n.

        Returns:
            One array (n, m) per output; (n, rows, columns) for a matrix.

        Raises:
            InputError: a shape that does not fit, or no argument that says n.
        """
        self._expect_count(arguments)
        flat = [self._rows(i, np.asarray(a, self.dtype)) for i, a in enumerate(arguments)]
        counts = {rows.shape[0] for rows in flat if rows.ndim == 2}
        if len(counts) != 1:
            raise InputError(
                f"{self.name}.map: found {sorted(counts) or 'no'} different numbers of rows; "
                "expected one n in all two-dimensional arguments; check the first dimension of each"
            )
        n = counts.pop()
        results = [np.empty((n, r * c), self.dtype) for r, c in self.output_shapes]
        strides = (ctypes.c_int64 * len(flat))(
            *(rows.shape[1] if rows.ndim == 2 else 0 for rows in flat)
        )
        self._library.map(ctypes.c_int64(n), _pointers(flat), strides, _pointers(results))
        return tuple(
            _unflatten(y, shape) for y, shape in zip(results, self.output_shapes, strict=True)
        )

    def rollout(
        self, x0: ArrayLike, inputs: ArrayLike, constants: ArrayLike = ()
    ) -> tuple[Array, Array]:
        """Iterate (x, u, p) -> (x+, y), looped in C; for a function of (x, u) leave `constants`
        out.

        Args:
            x0: first state, shape (nx,).
            inputs: one row per step, shape (n, nu).
            constants: p, shape (np,).

        Returns:
            (states, outputs): shapes (n + 1, nx) and (n, ny); row 0 of the states is x0.

        Raises:
            InputError: the function has another form, or a shape does not fit.
        """
        sizes_in = [r * c for r, c in self.input_shapes]
        if not can_roll(sizes_in, [r * c for r, c in self.output_shapes]):
            raise InputError(
                f"{self.name}: found inputs {self.input_names} and outputs {self.output_names}; "
                "expected "
                "(x, u, p) -> (x+, y) or (x, u) -> (x+, y) with x and x+ of one size; write the "
                "function so"
            )
        start = np.asarray(x0, self.dtype).ravel()
        given = np.ascontiguousarray(inputs, self.dtype)
        fixed = np.ascontiguousarray(constants, self.dtype).ravel()
        wanted_p = sizes_in[2] if len(sizes_in) == 3 else 0
        if start.size != sizes_in[0]:
            raise self._wrong_shape(0, start.shape, f"({sizes_in[0]},)")
        if given.ndim != 2 or given.shape[1] != sizes_in[1]:
            raise self._wrong_shape(1, given.shape, f"(n, {sizes_in[1]})")
        if fixed.size != wanted_p:
            raise InputError(f"{self.name}: found {fixed.size} constants; expected {wanted_p}")
        n = given.shape[0]
        width = int(np.prod(self.output_shapes[1]))
        states = np.empty((n + 1, start.size), self.dtype)
        states[0] = start
        outputs = np.empty((n, width), self.dtype)
        self._library.rollout(
            ctypes.c_int64(n), _pointer(states), _pointer(given), ctypes.c_int64(sizes_in[1]),
            _pointer(fixed), _pointer(outputs),
        )  # fmt: skip
        return states, outputs

    def _expect_count(self, arguments: tuple[ArrayLike, ...]) -> None:
        if len(arguments) != len(self.input_shapes):
            raise InputError(
                f"{self.name}: found {len(arguments)} arguments; "
                f"expected {len(self.input_shapes)}: {', '.join(self.input_names)}"
            )

    def _rows(self, i: int, given: Array) -> Array:
        """(n, k) contiguous with matrices column by column, or (k,) for a value that holds for
        all."""
        rows, columns = self.input_shapes[i]
        if columns == 1 or rows == 1:
            if given.ndim <= 1 and given.size == rows * columns:
                return np.ascontiguousarray(given).reshape(-1)
            if given.ndim == 2 and given.shape[1] == rows * columns:
                return np.ascontiguousarray(given)
        elif given.shape == (rows, columns):
            return given.ravel(order="F")
        elif given.ndim == 3 and given.shape[1:] == (rows, columns):
            return np.ascontiguousarray(given.transpose(0, 2, 1)).reshape(given.shape[0], -1)
        expected = f"(n, {rows * columns})" if 1 in (rows, columns) else f"(n, {rows}, {columns})"
        raise self._wrong_shape(i, given.shape, expected)

    def _wrong_shape(self, i: int, found: tuple[int, ...], expected: str) -> InputError:
        return InputError(
            f"{self.name}: argument {self.input_names[i]!r} has shape {found}; expected {expected}"
        )


def _views(block: Array, shapes: tuple[Shape, ...]) -> tuple[Array, ...]:
    views = []
    start = 0
    for rows, columns in shapes:
        part = block[start : start + rows * columns]
        views.append(part if 1 in (rows, columns) else part.reshape((rows, columns), order="F"))
        start += rows * columns
    return tuple(views)


def _unflatten(values: Array, shape: Shape) -> Array:
    rows, columns = shape
    return values if 1 in shape else values.reshape(-1, columns, rows).transpose(0, 2, 1)


def _pointer(array: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


def _pointers(arrays: list[Array]) -> ctypes.Array[ctypes.c_void_p]:
    return (ctypes.c_void_p * len(arrays))(*(a.ctypes.data for a in arrays))
