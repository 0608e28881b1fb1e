"""Bounds of an analytic function over complex discs around its arguments.

For every argument z_k with |z_k - m_k| <= r_k (z complex) the function's value lies within R of its
value at m. The rules below turn the operations of an SX function into such bounds; the result is
again an SX function, so the bounds run as machine code at a few times the cost of the function.
With Cauchy's integral they bound derivatives and interpolation errors along a path without a single
sample (Rump, Verification methods, 2010, section 10).
"""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.errors import InputError


def disc_function(function: ca.Function) -> ca.Function:
    """(m_1, …, r_1, …) -> R_1, …: radii of the outputs for centres m and radii r of the inputs.

    Raises:
        InputError: the function holds an operation without a rule (it is not analytic).
    """
    centres = [ca.SX.sym(name, *function.size_in(i)) for i, name in enumerate(function.name_in())]
    radii = [
        ca.SX.sym(f"r_{name}", *function.size_in(i)) for i, name in enumerate(function.name_in())
    ]
    outputs = [ca.SX.zeros(*function.size_out(i)) for i in range(function.n_out())]
    work: dict[int, tuple[ca.SX, ca.SX]] = {}
    for k in range(function.n_instructions()):
        op = function.instruction_id(k)
        i_in = function.instruction_input(k)
        i_out = function.instruction_output(k)
        if op == ca.OP_CONST:
            work[i_out[0]] = (ca.SX(function.instruction_constant(k)), ca.SX(0))
        elif op == ca.OP_INPUT:
            work[i_out[0]] = (centres[i_in[0]].nz[i_in[1]], radii[i_in[0]].nz[i_in[1]])
        elif op == ca.OP_OUTPUT:
            outputs[i_out[0]].nz[i_out[1]] = work[i_in[0]][1]
        else:
            work[i_out[0]] = _apply(op, [work[i] for i in i_in], function.name())
    names = [*function.name_in(), *(f"r_{name}" for name in function.name_in())]
    return ca.Function(
        f"{function.name()}_radius",
        [*centres, *radii],
        [ca.densify(ca.cse(o)) for o in outputs],
        names,
        function.name_out(),
    )


def _apply(op: int, arguments: list[tuple[ca.SX, ca.SX]], name: str) -> tuple[ca.SX, ca.SX]:
    """Centre and radius of one operation's result."""
    x, rx = arguments[0]
    if len(arguments) == 2:
        y, ry = arguments[1]
        if op == ca.OP_ADD:
            return x + y, rx + ry
        if op == ca.OP_SUB:
            return x - y, rx + ry
        if op == ca.OP_MUL:
            return x * y, ca.fabs(x) * ry + rx * (ca.fabs(y) + ry)
        if op == ca.OP_DIV:
            inverse, r_inverse = _inverse(y, ry)
            return x / y, ca.fabs(x) * r_inverse + rx * (ca.fabs(inverse) + r_inverse)
        if (
            op in {ca.OP_CONSTPOW, ca.OP_POW}
            and y.is_constant()
            and float(y) == int(float(y))
            and 0 < float(y) <= 4
        ):
            result = (x, rx)
            for _ in range(int(float(y)) - 1):
                result = _apply(ca.OP_MUL, [result, (x, rx)], name)
            return result
    elif op == ca.OP_NEG:
        return -x, rx
    elif op == ca.OP_TWICE:
        return 2 * x, 2 * rx
    elif op == ca.OP_SQ:
        return x * x, rx * (2 * ca.fabs(x) + rx)
    elif op == ca.OP_INV:
        return _inverse(x, rx)
    elif op == ca.OP_SIN:
        # |sin z - sin x| <= |cos x| sinh r + |sin x| (cosh r - 1)
        return ca.sin(x), ca.fabs(ca.cos(x)) * _sinh(rx) + ca.fabs(ca.sin(x)) * _cosh_less_one(rx)
    elif op == ca.OP_COS:
        return ca.cos(x), ca.fabs(ca.sin(x)) * _sinh(rx) + ca.fabs(ca.cos(x)) * _cosh_less_one(rx)
    elif op == ca.OP_EXP:
        return ca.exp(x), ca.exp(x) * (ca.exp(rx) - 1)
    elif op == ca.OP_SQRT:
        # |sqrt z - sqrt x| = |z - x| / |sqrt z + sqrt x| <= r / sqrt x, as the real parts add up;
        # needs |z - x| < x
        return ca.sqrt(x), ca.if_else(rx < x, rx / ca.sqrt(x), 1e300)
    raise InputError(
        f"{name}: operation {op} has no bound over complex discs; the effect must be analytic"
    )


def _inverse(y: ca.SX, ry: ca.SX) -> tuple[ca.SX, ca.SX]:
    """1 / y: the radius is |1/z - 1/y| <= r / (|y| (|y| - r)), without bound when the disc holds
    zero."""
    size = ca.fabs(y)
    return 1 / y, ca.if_else(ry < size, ry / (size * (size - ry)), 1e300)


def _sinh(r: ca.SX) -> ca.SX:
    """Upper bound of sinh r for r <= 1: r + r^3 / 6 + r^5 / 100 (the rest of the series is below
    r^5 / 5000)."""
    square = r * r
    return ca.if_else(r <= 1, r * (1 + square * (1 / 6 + square / 100)), 1e300)


def _cosh_less_one(r: ca.SX) -> ca.SX:
    """Upper bound of cosh r - 1 for r <= 1: r^2 / 2 + r^4 / 20."""
    square = r * r
    return ca.if_else(r <= 1, square * (0.5 + square / 20), 1e300)
