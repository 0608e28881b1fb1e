"""Bounds of an analytic function over complex discs around its arguments.

For every argument z_k with |z_k - m_k| <= r_k (z complex) the function's value lies within R of its
value at m. The rules below turn the operations of an SX function into such bounds; the result is
again an SX function, so the bounds run as machine code at a few times the cost of the function.
With Cauchy's integral they bound derivatives and interpolation errors along a path without a single
sample (Rump, Verification methods, 2010, section 10).
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from irb2400_ctrl.symbolic import Algebra, NoRule, walk

Disc = tuple[ca.SX, ca.SX]
"""centre and radius"""


def disc_function(function: ca.Function) -> ca.Function:
    """(m_1, …, r_1, …) -> R_1, …: radii of the outputs for centres m and radii r of the inputs.

    Raises:
        InputError: the function holds an operation without a rule (it is not analytic).
    """
    centres = [ca.SX.sym(name, *function.size_in(i)) for i, name in enumerate(function.name_in())]
    radii = [
        ca.SX.sym(f"r_{name}", *function.size_in(i)) for i, name in enumerate(function.name_in())
    ]
    found = walk(function, _DISCS, lambda k, i: (centres[k].nz[i], radii[k].nz[i]))
    outputs = [ca.SX.zeros(*function.size_out(k)) for k in range(function.n_out())]
    for output, discs in zip(outputs, found, strict=True):
        for place, (_, radius) in enumerate(discs):
            output.nz[place] = radius
    names = [*function.name_in(), *(f"r_{name}" for name in function.name_in())]
    return ca.Function(
        f"{function.name()}_radius",
        [*centres, *radii],
        [ca.densify(ca.cse(o)) for o in outputs],
        names,
        function.name_out(),
    )


class _Discs(Algebra[Disc]):
    """Numbers are discs; the rules bound the radius of the result."""

    expected = "the function must be analytic to have a bound over complex discs"

    def constant(self, value: float) -> Disc:
        return ca.SX(value), ca.SX(0)

    def rule(self, op: int) -> Callable[..., Disc] | None:
        return _RULES.get(op)


_DISCS = _Discs()


def _multiply(x: Disc, y: Disc) -> Disc:
    m, r = x
    n, s = y
    return m * n, ca.fabs(m) * s + r * (ca.fabs(n) + s)


def _divide(x: Disc, y: Disc) -> Disc:
    m, r = x
    n, s = y
    inverse, r_inverse = _inverse((n, s))
    return m / n, ca.fabs(m) * r_inverse + r * (ca.fabs(inverse) + r_inverse)


def _power(x: Disc, y: Disc) -> Disc:
    """Whole powers up to the fourth."""
    exponent = y[0]
    if not (exponent.is_constant() and float(exponent) in {1.0, 2.0, 3.0, 4.0}):
        raise NoRule(ca.OP_POW)
    result = x
    for _ in range(int(float(exponent)) - 1):
        result = _multiply(result, x)
    return result


def _sine(x: Disc) -> Disc:
    # |sin z - sin x| <= |cos x| sinh r + |sin x| (cosh r - 1)
    m, r = x
    return ca.sin(m), ca.fabs(ca.cos(m)) * _sinh(r) + ca.fabs(ca.sin(m)) * _cosh_less_one(r)


def _cosine(x: Disc) -> Disc:
    m, r = x
    return ca.cos(m), ca.fabs(ca.sin(m)) * _sinh(r) + ca.fabs(ca.cos(m)) * _cosh_less_one(r)


def _root(x: Disc) -> Disc:
    # |sqrt z - sqrt x| = |z - x| / |sqrt z + sqrt x| <= r / sqrt x, as the real parts add up;
    # needs |z - x| < x
    m, r = x
    return ca.sqrt(m), ca.if_else(r < m, r / ca.sqrt(m), 1e300)


def _inverse(y: Disc) -> Disc:
    """1 / y: the radius is |1/z - 1/y| <= r / (|y| (|y| - r)), without bound when the disc holds
    zero."""
    m, r = y
    size = ca.fabs(m)
    return 1 / m, ca.if_else(r < size, r / (size * (size - r)), 1e300)


def _sinh(r: ca.SX) -> ca.SX:
    """Upper bound of sinh r for r <= 1: r + r^3 / 6 + r^5 / 100 (the rest of the series is below
    r^5 / 5000)."""
    square = r * r
    return ca.if_else(r <= 1, r * (1 + square * (1 / 6 + square / 100)), 1e300)


def _cosh_less_one(r: ca.SX) -> ca.SX:
    """Upper bound of cosh r - 1 for r <= 1: r^2 / 2 + r^4 / 20."""
    square = r * r
    return ca.if_else(r <= 1, square * (0.5 + square / 20), 1e300)


_RULES: dict[int, Callable[..., Disc]] = {
    ca.OP_ADD: lambda x, y: (x[0] + y[0], x[1] + y[1]),
    ca.OP_SUB: lambda x, y: (x[0] - y[0], x[1] + y[1]),
    ca.OP_MUL: _multiply,
    ca.OP_DIV: _divide,
    ca.OP_POW: _power,
    ca.OP_CONSTPOW: _power,
    ca.OP_NEG: lambda x: (-x[0], x[1]),
    ca.OP_TWICE: lambda x: (2 * x[0], 2 * x[1]),
    ca.OP_SQ: lambda x: (x[0] * x[0], x[1] * (2 * ca.fabs(x[0]) + x[1])),
    ca.OP_INV: _inverse,
    ca.OP_SIN: _sine,
    ca.OP_COS: _cosine,
    ca.OP_EXP: lambda x: (ca.exp(x[0]), ca.exp(x[0]) * (ca.exp(x[1]) - 1)),
    ca.OP_SQRT: _root,
}
