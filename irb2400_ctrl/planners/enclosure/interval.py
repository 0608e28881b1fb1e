"""Bounds of a function over boxes: interval arithmetic on the operations of an SX function, many
boxes at once.

Every operation has a rule that turns bounds of its arguments into bounds of its result, so that the
outputs' bounds hold for every point of a box (Moore, Kearfott, Cloud, Introduction to Interval
Analysis, 2009, chapter 2). Unlike the discs of `complex_disc` the rules know kinks, jumps and
powers of a speed; infinite ends stand for "no bound".
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import InputError

Array = npt.NDArray[np.float64]
Interval = tuple[Array, Array]
"""lower and upper ends, shapes that broadcast"""


def interval_function(function: ca.Function, arguments: list[Interval]) -> list[Interval]:
    """Bounds of the scalar outputs over boxes.

    Args:
        function: an SX function of scalars.
        arguments: one interval per input.

    Raises:
        InputError: an operation without a rule.
    """
    outputs: list[Interval] = [(np.zeros(1), np.zeros(1))] * function.n_out()
    work: dict[int, Interval] = {}
    with np.errstate(all="ignore"):
        for k in range(function.n_instructions()):
            op = function.instruction_id(k)
            i_in = function.instruction_input(k)
            i_out = function.instruction_output(k)
            if op == ca.OP_CONST:
                value = np.array([float(function.instruction_constant(k))])
                work[i_out[0]] = (value, value)
            elif op == ca.OP_INPUT:
                work[i_out[0]] = arguments[i_in[0]]
            elif op == ca.OP_OUTPUT:
                outputs[i_out[0]] = work[i_in[0]]
            else:
                work[i_out[0]] = apply(op, [work[i] for i in i_in], function.name())
    return outputs


def apply(op: int, arguments: list[Interval], name: str) -> Interval:
    """Bounds of one operation's result."""
    x = arguments[0]
    y = arguments[1] if len(arguments) == 2 else x
    if op in _MONOTONE:
        rule = _MONOTONE[op]
        return rule(x[0]), rule(x[1])
    if op == ca.OP_ADD:
        return x[0] + y[0], x[1] + y[1]
    if op == ca.OP_SUB:
        return x[0] - y[1], x[1] - y[0]
    if op in {ca.OP_MUL, ca.OP_IF_ELSE_ZERO, ca.OP_AND}:
        return _product(x, y)
    if op == ca.OP_DIV:
        return _product(x, _inverse(y))
    if op == ca.OP_INV:
        return _inverse(x)
    if op == ca.OP_NEG:
        return -x[1], -x[0]
    if op == ca.OP_NOT:
        return 1 - x[1], 1 - x[0]
    if op == ca.OP_FABS:
        return _size(x)
    if op == ca.OP_SQ:
        size = _size(x)
        return size[0] ** 2, size[1] ** 2
    if op in {ca.OP_POW, ca.OP_CONSTPOW} and (y[0] == y[1]).all():
        return _power(x, y[0])
    if op in {ca.OP_LT, ca.OP_LE}:
        strict = op == ca.OP_LT
        surely = x[1] < y[0] if strict else x[1] <= y[0]
        never = x[0] >= y[1] if strict else x[0] > y[1]
        return surely.astype(float), (~never).astype(float)
    if op == ca.OP_FMIN:
        return np.minimum(x[0], y[0]), np.minimum(x[1], y[1])
    if op == ca.OP_FMAX:
        return np.maximum(x[0], y[0]), np.maximum(x[1], y[1])
    raise InputError(f"{name}: operation {op} has no bound over intervals")


_MONOTONE: dict[int, Callable[[Array], Array]] = {
    ca.OP_EXP: np.exp,
    ca.OP_SIGN: np.sign,
    ca.OP_SQRT: lambda x: np.sqrt(np.maximum(x, 0.0)),
    ca.OP_LOG: lambda x: np.log(np.maximum(x, 0.0)),
    ca.OP_TWICE: lambda x: 2 * x,
}


def _product(x: Interval, y: Interval) -> Interval:
    # zero times "no bound" is zero: the values themselves are finite
    ends = [np.nan_to_num(a * b, nan=0.0, posinf=np.inf, neginf=-np.inf) for a in x for b in y]
    return np.minimum.reduce(np.broadcast_arrays(*ends)), np.maximum.reduce(
        np.broadcast_arrays(*ends)
    )


def _inverse(x: Interval) -> Interval:
    low, high = x
    inside = (low < 0) & (high > 0)
    # an end at zero counts as approached from inside the interval
    first = np.where(
        inside, -np.inf, np.where(high == 0, -np.inf, 1 / np.where(high == 0, 1.0, high))
    )
    last = np.where(inside, np.inf, np.where(low == 0, np.inf, 1 / np.where(low == 0, 1.0, low)))
    nothing = (low == 0) & (high == 0)
    return np.where(nothing, -np.inf, first), np.where(nothing, np.inf, last)


def _size(x: Interval) -> Interval:
    low = np.abs(x[0])
    high = np.abs(x[1])
    across = (x[0] <= 0) & (x[1] >= 0)
    return np.where(across, 0.0, np.minimum(low, high)), np.maximum(low, high)


def _power(x: Interval, exponent: Array) -> Interval:
    """x^p with a fixed p: whole powers of any x, others of x >= 0."""
    p = float(exponent.ravel()[0])
    if p == 0:
        return np.ones_like(x[0]), np.ones_like(x[1])
    if p < 0:
        return _inverse(_power(x, -exponent))
    if p != int(p):
        return np.maximum(x[0], 0.0) ** p, np.maximum(x[1], 0.0) ** p
    if int(p) % 2:
        return x[0] ** p, x[1] ** p
    size = _size(x)
    return size[0] ** p, size[1] ** p
