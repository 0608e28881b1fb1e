"""A function walked in an algebra is the function: with plain numbers, with dual numbers, with
expressions."""

from __future__ import annotations

import math
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.symbolic import Algebra, NoRule, Walk, walk

X = ca.SX.sym("x", 3)
a, b, c = ca.vertsplit(X)
EVERY = {
    "add": a + b,
    "sub": a - b,
    "mul": a * b,
    "div": a / b,
    "neg": -a,
    "sq": a**2,
    "twice": 2 * a,
    "inv": 1 / a,
    "pow": ca.fabs(a) ** c,
    "constpow": ca.constpow(ca.fabs(a), 2.5),
    "exp": ca.exp(a),
    "log": ca.log(ca.fabs(a)),
    "log1p": ca.log1p(ca.fabs(a)),
    "expm1": ca.expm1(a),
    "sqrt": ca.sqrt(ca.fabs(a)),
    "sin": ca.sin(a),
    "cos": ca.cos(a),
    "tan": ca.tan(a),
    "asin": ca.asin(a / 4),
    "acos": ca.acos(a / 4),
    "atan": ca.atan(a),
    "atan2": ca.atan2(a, b),
    "sinh": ca.sinh(a),
    "cosh": ca.cosh(a),
    "tanh": ca.tanh(a),
    "asinh": ca.asinh(a),
    "acosh": ca.acosh(1 + ca.fabs(a)),
    "atanh": ca.atanh(a / 4),
    "erf": ca.erf(a),
    "hypot": ca.hypot(a, b),
    "floor": ca.floor(a),
    "ceil": ca.ceil(a),
    "fmod": ca.fmod(a, b),
    "remainder": ca.remainder(a, b),
    "fabs": ca.fabs(a),
    "sign": ca.sign(a),
    "copysign": ca.copysign(a, b),
    "fmin": ca.fmin(a, b),
    "fmax": ca.fmax(a, b),
    "lt": a < b,
    "le": a <= b,
    "eq": a == b,
    "ne": a != b,
    "and": ca.logic_and(a, b),
    "or": ca.logic_or(a, b),
    "not": ca.logic_not(a),
    "if_else_zero": ca.if_else(a < b, c, 0),
}


class Expressions(Algebra[ca.DM]):
    """CasADi's own numbers; counts the operations and notes them."""

    def __init__(self) -> None:
        self.used: list[int] = []

    def constant(self, value: float) -> ca.DM:
        return ca.DM(value)

    def rule(self, op: int) -> Callable[..., ca.DM]:
        def apply(*operands: ca.DM) -> ca.DM:
            self.used.append(op)
            return ca.DM.unary(op, *operands) if len(operands) == 1 else ca.DM.binary(op, *operands)

        return apply


Dual = tuple[float, float]


class Duals(Algebra[Dual]):
    """Value and derivative."""

    expected = "expected sums, products and sines of numbers below ten"

    def constant(self, value: float) -> Dual:
        return value, 0.0

    def rule(self, op: int) -> Callable[..., Dual] | None:
        def sine(x: Dual) -> Dual:
            if x[0] > 10:
                raise NoRule(op)
            return math.sin(x[0]), math.cos(x[0]) * x[1]

        rules: dict[int, Callable[..., Dual]] = {
            ca.OP_ADD: lambda x, y: (x[0] + y[0], x[1] + y[1]),
            ca.OP_SUB: lambda x, y: (x[0] - y[0], x[1] - y[1]),
            ca.OP_MUL: lambda x, y: (x[0] * y[0], x[1] * y[0] + x[0] * y[1]),
            ca.OP_SQ: lambda x: (x[0] ** 2, 2 * x[0] * x[1]),
            ca.OP_TWICE: lambda x: (2 * x[0], 2 * x[1]),
            ca.OP_SIN: sine,
        }
        return rules.get(op)


@pytest.mark.parametrize("name", EVERY)
def test_every_operation_comes_with_its_operands_in_order(name: str) -> None:
    function = ca.Function("f", [X], [EVERY[name]])
    algebra = Expressions()
    rng = np.random.default_rng(0)
    for point in rng.uniform(-3, 3, (20, 3)):
        ((found,),) = walk(function, algebra, lambda _, i, at=point: ca.DM(at[i]))
        np.testing.assert_equal(float(found), float(function(point)))
    assert getattr(ca, f"OP_{name.upper()}") in algebra.used


def test_constants_and_several_sparse_arguments_and_outputs() -> None:
    x = ca.SX.sym("x", ca.Sparsity.diag(3))
    y = ca.SX.sym("y", 2)
    outputs = [ca.mtimes(x, ca.SX([1.5, 2, 3])), ca.SX(2, 2), y[1] - 0.25, x]
    function = ca.Function("f", [x, y], outputs)
    at = [np.array([3.0, 5.0, 7.0]), np.array([11.0, 13.0])]
    found = walk(function, Expressions(), lambda k, i: ca.DM(at[k][i]))
    assert [[float(v) for v in column] for column in found] == [
        [4.5, 10, 21],
        [],
        [12.75],
        [3, 5, 7],
    ]


def test_dual_numbers_give_the_derivative() -> None:
    f = ca.sin(a * b + 2 * c) * a**2 - b + 0.5
    function = ca.Function("f", [X], [f])
    slope = ca.Function("slope", [X], [ca.jtimes(f, X, ca.DM([1, 2, -1]))])
    point = [0.3, -0.7, 1.1]
    bound = Walk(function, Duals())
    for shift in (0.0, 0.5):
        at = [p + shift for p in point]
        ((found,),) = bound(lambda _, i, at=at: (at[i], (1.0, 2.0, -1.0)[i]))
        assert found == pytest.approx((float(function(at)), float(slope(at))), rel=1e-14)


def test_an_operation_without_a_rule_is_named() -> None:
    with pytest.raises(InputError, match=r"lawful.*'tan'.*expected sums, products"):
        walk(ca.Function("lawful", [X], [ca.tan(a)]), Duals(), lambda _, i: (1.0, 0.0))
    with pytest.raises(InputError, match=r"lawful.*'sin'.*below ten"):
        walk(ca.Function("lawful", [X], [ca.sin(a)]), Duals(), lambda _, i: (11.0, 0.0))


def test_functions_of_mx_are_expanded_and_look_ups_refused() -> None:
    x = ca.MX.sym("x", 3)
    function = ca.Function("f", [x], [ca.dot(x, x)])
    ((found,),) = walk(function, Expressions(), lambda _, i: ca.DM(i + 1))
    assert float(found) == 14
    table = ca.interpolant("table", "bspline", [[0.0, 1, 2, 3]], [0.0, 1, 4, 9])
    with pytest.raises(InputError, match="calls another function inside"):
        walk(table, Expressions(), lambda _, i: ca.DM(1))
    with pytest.raises(InputError, match="free variables"):
        Walk(ca.Function("f", [a], [a + b], {"allow_free": True}), Expressions())
    inner = ca.Function("inner", [a], [ca.sin(a)], {"never_inline": True})
    with pytest.raises(InputError, match="calls another function inside"):
        Walk(ca.Function("outer", [a], [inner(a)]), Expressions())
