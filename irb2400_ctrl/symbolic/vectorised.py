"""A CasADi expression evaluated on numpy arrays: every instruction works on all samples at once,
with broadcasting.

An effect's law is one scalar expression; a log has ten thousand samples and a ripple some hundred
orders to try. Walking the instruction list with arrays costs one numpy call per operation, whatever
the number of samples.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.symbolic.walk import Algebra, Walk

BLOCK = 16_384
"""numbers of an array that is worked on at once: a few of them stay in the processor's cache"""


def _divide(x: Array, y: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(x / y)


_UNARY: dict[int, Callable[[Any], Any]] = {
    ca.OP_ASSIGN: lambda x: x,
    ca.OP_NEG: np.negative,
    ca.OP_SQ: np.square,
    ca.OP_TWICE: lambda x: 2.0 * x,
    ca.OP_SQRT: np.sqrt,
    ca.OP_SIN: np.sin,
    ca.OP_COS: np.cos,
    ca.OP_TAN: np.tan,
    ca.OP_ASIN: np.arcsin,
    ca.OP_ACOS: np.arccos,
    ca.OP_ATAN: np.arctan,
    ca.OP_SINH: np.sinh,
    ca.OP_COSH: np.cosh,
    ca.OP_ASINH: np.arcsinh,
    ca.OP_TANH: np.tanh,
    ca.OP_EXP: np.exp,
    ca.OP_LOG: np.log,
    ca.OP_FABS: np.abs,
    ca.OP_SIGN: np.sign,
    ca.OP_INV: lambda x: _divide(1.0, x),  # type: ignore[arg-type]
    ca.OP_FLOOR: np.floor,
    ca.OP_CEIL: np.ceil,
    ca.OP_NOT: lambda x: np.where(x == 0, 1.0, 0.0),
}
_BINARY: dict[int, Callable[[Any, Any], Any]] = {
    ca.OP_ADD: np.add,
    ca.OP_SUB: np.subtract,
    ca.OP_MUL: np.multiply,
    ca.OP_DIV: _divide,
    ca.OP_POW: np.power,
    ca.OP_CONSTPOW: np.power,
    ca.OP_FMIN: np.fmin,
    ca.OP_FMAX: np.fmax,
    ca.OP_ATAN2: np.arctan2,
    ca.OP_FMOD: np.fmod,
    ca.OP_HYPOT: np.hypot,
    ca.OP_LT: lambda x, y: np.where(x < y, 1.0, 0.0),
    ca.OP_LE: lambda x, y: np.where(x <= y, 1.0, 0.0),
    ca.OP_EQ: lambda x, y: np.where(x == y, 1.0, 0.0),
    ca.OP_NE: lambda x, y: np.where(x != y, 1.0, 0.0),
    ca.OP_AND: lambda x, y: np.where((x != 0) & (y != 0), 1.0, 0.0),
    ca.OP_OR: lambda x, y: np.where((x != 0) | (y != 0), 1.0, 0.0),
    # if_else(c, a, b) is written as c * a + !c * b with a product that is zero whenever c is
    ca.OP_IF_ELSE_ZERO: lambda c, x: np.where(c != 0, x, 0.0),
}


class OnArrays(Algebra[Any]):
    """Numbers are arrays of shapes that broadcast."""

    expected = "expected an operation that numpy has"

    def constant(self, value: float) -> float:
        """The number itself: it fits beside any array."""
        return value

    def rule(self, op: int) -> Callable[..., Any] | None:
        """numpy's operation."""
        return _BINARY.get(op) or _UNARY.get(op)


class Vectorised:
    """An SX function of scalars; call it with one array per scalar input, all of shapes that
    broadcast."""

    def __init__(self, inputs: list[ca.SX], outputs: ca.SX) -> None:
        """Inputs: scalar symbols; outputs: column of scalar expressions."""
        packed = ca.vertcat(*inputs) if inputs else ca.SX(0, 1)
        function = ca.Function("vectorised", [packed], [ca.densify(outputs)], {"cse": True})
        self.size = outputs.numel()
        self._walk = Walk(function, OnArrays())

    def __call__(self, *values: Array | float) -> list[Array]:
        """The outputs, each of the broadcast shape of what it depends on."""
        shape = np.broadcast_shapes(*(np.shape(value) for value in values))
        step = max(2, BLOCK // max(1, int(np.prod(shape[1:]))))
        if not shape or shape[0] <= step:
            return self._at(lambda _, i: values[i])
        cut = [_along(value, shape) for value in values]

        def at(rows: slice) -> list[Array]:
            # of the many inputs a law asks for few
            return self._at(lambda _, i: np.asarray(values[i])[rows] if cut[i] else values[i])

        first = at(slice(step))
        long = [place for place, part in enumerate(first) if _along(part, (step, *shape[1:]))]
        outputs = [
            np.empty((shape[0], *part.shape[1:])) if place in long else part
            for place, part in enumerate(first)
        ]
        for start in range(0, shape[0], step):
            rows = slice(start, start + step)
            parts = at(rows) if start else first
            for place in long:
                outputs[place][rows] = parts[place]
        return outputs

    def _at(self, values: Callable[[int, int], Array | float]) -> list[Array]:
        (outputs,) = self._walk(values)
        return [np.asarray(value, dtype=float) for value in outputs]


def _along(value: Array | float, shape: tuple[int, ...]) -> bool:
    """Whether a value has the first dimension of a shape that it broadcasts to."""
    return np.ndim(value) == len(shape) and np.shape(value)[0] == shape[0]
