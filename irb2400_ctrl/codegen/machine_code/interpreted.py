"""`Interpreter`: a function through CasADi's virtual machine, where there is no C compiler."""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array


class Interpreter:
    """Stands in for the shared library of a `CompiledFunction`: the same three entry points on the
    same memory, about thirty times slower. Numbers agree to the last bits of sine and exponential,
    which come from the C library here. Not for several threads at once.
    """

    def __init__(self, fn: ca.Function, dtype: np.dtype[Any]) -> None:
        self._dtype = dtype
        fn = _dense(fn)
        buffer: Any
        buffer, self._evaluate = fn.buffer()
        # CasADi keeps no reference to the memory it reads and writes
        self._buffer = buffer
        self._inputs = [np.zeros(fn.numel_in(i)) for i in range(fn.n_in())]
        self._outputs = [np.zeros(fn.numel_out(i)) for i in range(fn.n_out())]
        for i, array in enumerate(self._inputs):
            buffer.set_arg(i, array.data)
        for i, array in enumerate(self._outputs):
            buffer.set_res(i, array.data)

    def run(self, given: ctypes.c_void_p, results: ctypes.c_void_p) -> None:
        """One evaluation: all inputs in one block, all outputs in another."""
        self._step(
            self._split(given, self._inputs),
            self._split(results, self._outputs),
        )

    def map(
        self,
        n: ctypes.c_int64,
        given: ctypes.Array[ctypes.c_void_p],
        strides: ctypes.Array[ctypes.c_int64],
        results: ctypes.Array[ctypes.c_void_p],
    ) -> None:
        """n evaluations; an input of stride 0 is the same for all."""
        count = n.value
        inputs = [
            self._table(at, count if stride else 1, part.size)
            for at, stride, part in zip(given, strides, self._inputs, strict=True)
        ]
        outputs = [
            self._table(at, count, part.size)
            for at, part in zip(results, self._outputs, strict=True)
        ]
        for k in range(count):
            rows = [table[k if len(table) > 1 else 0] for table in inputs]
            self._step(rows, [table[k] for table in outputs])

    def rollout(
        self,
        n: ctypes.c_int64,
        states: ctypes.c_void_p,
        given: ctypes.c_void_p,
        stride: ctypes.c_int64,
        constants: ctypes.c_void_p,
        results: ctypes.c_void_p,
    ) -> None:
        """x+, y = f(x, u, p), n times; row k + 1 of the states follows from row k."""
        count = n.value
        x = self._table(states.value, count + 1, self._inputs[0].size)
        u = self._table(given.value, count, stride.value)
        y = self._table(results.value, count, self._outputs[1].size)
        fixed = [self._table(constants.value, 1, part.size)[0] for part in self._inputs[2:]]
        for k in range(count):
            self._step([x[k], u[k], *fixed], [x[k + 1], y[k]])

    def _step(self, rows: list[Array], results: list[Array]) -> None:
        for part, row in zip(self._inputs, rows, strict=True):
            part[...] = row
        self._evaluate()
        for row, part in zip(results, self._outputs, strict=True):
            row[...] = part

    def _split(self, block: ctypes.c_void_p, parts: list[Array]) -> list[Array]:
        ends = np.cumsum([part.size for part in parts], dtype=int)
        table = self._table(block.value, 1, int(ends[-1]) if parts else 0)[0]
        return np.split(table, ends[:-1]) if parts else []

    def _table(self, at: int | None, rows: int, columns: int) -> Array:
        """The memory at an address as an array (rows, columns), not copied."""
        size = rows * columns
        if not at or not size:
            return np.zeros((rows, columns), self._dtype)
        memory: Any = (ctypes.c_char * (size * self._dtype.itemsize)).from_address(at)
        return np.ndarray((rows, columns), self._dtype, memory)


def _dense(fn: ca.Function) -> ca.Function:
    """The function with every argument stored in full, as its C form has them."""
    inputs = [ca.SX.sym(fn.name_in(i), *fn.size_in(i)) for i in range(fn.n_in())]
    outputs = [ca.densify(value) for value in fn.call(inputs)]
    return ca.Function(fn.name(), inputs, outputs)


@cache
def say_slow(reason: str) -> None:
    """Once a process, on stderr: what is missing and what it costs."""
    print(
        f"irb2400: {reason}; going on without machine code, about thirty times slower",
        file=sys.stderr,
    )
