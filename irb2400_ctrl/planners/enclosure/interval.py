"""Bounds of a function over boxes: interval arithmetic on the operations of an SX function, many
boxes at once.

Every operation has a rule that turns bounds of its arguments into bounds of its result, so that the
outputs' bounds hold for every point of a box (Moore, Kearfott, Cloud, Introduction to Interval
Analysis, 2009, chapter 2). Unlike the discs of `complex_disc` the rules know kinks, jumps and
powers of a speed; infinite ends stand for "no bound".
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.symbolic import Algebra, NoRule, Walk

Interval = tuple[Array, Array]
"""lower and upper ends, shapes that broadcast"""


def interval_function(function: ca.Function) -> Callable[[list[Interval]], list[Interval]]:
    """Bounds of the scalar outputs over boxes, from one interval per input.

    Args:
        function: an SX function of scalars.

    Raises:
        InputError: an operation without a rule, when the function is read or for some boxes.
    """
    bound = Walk(function, INTERVALS)

    def bounds(arguments: list[Interval]) -> list[Interval]:
        with np.errstate(all="ignore"):
            found = bound(lambda k, _: arguments[k])
        # an output without a structural nonzero is zero
        return [column[0] if column else INTERVALS.constant(0.0) for column in found]

    return bounds


class _Intervals(Algebra[Interval]):
    """Numbers are intervals, many at once."""

    expected = "it has no bound over intervals"

    def constant(self, value: float) -> Interval:
        end = np.array([value])
        return end, end

    def rule(self, op: int) -> Callable[..., Interval] | None:
        if op in _MONOTONE:
            return _growing(_MONOTONE[op])
        return _RULES.get(op)


INTERVALS = _Intervals()


def _growing(f: Callable[[Array], Array]) -> Callable[[Interval], Interval]:
    return lambda x: (f(x[0]), f(x[1]))


_MONOTONE: dict[int, Callable[[Array], Array]] = {
    ca.OP_EXP: np.exp,
    ca.OP_SIGN: np.sign,
    ca.OP_SQRT: lambda x: np.sqrt(np.maximum(x, 0.0)),
    ca.OP_LOG: lambda x: np.log(np.maximum(x, 0.0)),
    ca.OP_TWICE: lambda x: 2 * x,
}


def _product(x: Interval, y: Interval) -> Interval:
    # a number has one end
    ends = [_times(a, b) for a in _ends(x) for b in _ends(y)]
    return reduce(np.minimum, ends), reduce(np.maximum, ends)


def _ends(x: Interval) -> Interval | tuple[Array]:
    return x[:1] if x[0] is x[1] else x


def _times(a: Array, b: Array) -> Array:
    """Zero times "no bound" is zero: the values themselves are finite."""
    product = np.asarray(a * b)
    nothing = np.isnan(product)
    return np.where(nothing, 0.0, product) if nothing.any() else product


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


def _square(x: Interval) -> Interval:
    low, high = _size(x)
    return low**2, high**2


def _raised_to(x: Interval, y: Interval) -> Interval:
    if not (y[0] == y[1]).all():
        raise NoRule(ca.OP_POW)
    return _power(x, y[0])


def _below(x: Interval, y: Interval) -> Interval:
    return (x[1] < y[0]).astype(float), (~(x[0] >= y[1])).astype(float)


def _at_most(x: Interval, y: Interval) -> Interval:
    return (x[1] <= y[0]).astype(float), (~(x[0] > y[1])).astype(float)


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


_RULES: dict[int, Callable[..., Interval]] = {
    ca.OP_ADD: lambda x, y: (x[0] + y[0], x[1] + y[1]),
    ca.OP_SUB: lambda x, y: (x[0] - y[1], x[1] - y[0]),
    ca.OP_MUL: _product,
    ca.OP_IF_ELSE_ZERO: _product,
    ca.OP_AND: _product,
    ca.OP_DIV: lambda x, y: _product(x, _inverse(y)),
    ca.OP_INV: _inverse,
    ca.OP_NEG: lambda x: (-x[1], -x[0]),
    ca.OP_NOT: lambda x: (1 - x[1], 1 - x[0]),
    ca.OP_FABS: _size,
    ca.OP_SQ: _square,
    ca.OP_POW: _raised_to,
    ca.OP_CONSTPOW: _raised_to,
    ca.OP_LT: _below,
    ca.OP_LE: _at_most,
    ca.OP_FMIN: lambda x, y: (np.minimum(x[0], y[0]), np.minimum(x[1], y[1])),
    ca.OP_FMAX: lambda x, y: (np.maximum(x[0], y[0]), np.maximum(x[1], y[1])),
}
