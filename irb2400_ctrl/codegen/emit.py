"""C99 text of a `casadi.Function`: one `const` local per operation, no work array, no library
needed.

Reals are written `R(0.5)` and typed `real_t`; both are defined by the file around (float or
double), so that one text serves both precisions and no double constant slips into a float build.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from irb2400_ctrl.codegen.graph import COSINE_OF, SELECT, SINCOS, SINE_OF, Graph
from irb2400_ctrl.codegen.own_math import own_functions
from irb2400_ctrl.errors import InputError

_INFIX = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*", ca.OP_DIV: "/"}
_COMPARE = {ca.OP_LT: "<", ca.OP_LE: "<=", ca.OP_EQ: "==", ca.OP_NE: "!="}
_LOGIC = {ca.OP_AND: "&&", ca.OP_OR: "||"}
_CALL = {
    ca.OP_EXP: "exp",
    ca.OP_LOG: "log",
    ca.OP_SQRT: "sqrt",
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_TAN: "tan",
    ca.OP_ASIN: "asin",
    ca.OP_ACOS: "acos",
    ca.OP_ATAN: "atan",
    ca.OP_FLOOR: "floor",
    ca.OP_CEIL: "ceil",
    ca.OP_FMOD: "fmod",
    ca.OP_FABS: "abs",
    ca.OP_SIGN: "sign",
    ca.OP_COPYSIGN: "copysign",
    ca.OP_ERF: "erf",
    ca.OP_FMIN: "fmin",
    ca.OP_FMAX: "fmax",
    ca.OP_SINH: "sinh",
    ca.OP_COSH: "cosh",
    ca.OP_TANH: "tanh",
    ca.OP_ASINH: "asinh",
    ca.OP_ACOSH: "acosh",
    ca.OP_ATANH: "atanh",
    ca.OP_ATAN2: "atan2",
    ca.OP_LOG1P: "log1p",
    ca.OP_EXPM1: "expm1",
    ca.OP_HYPOT: "hypot",
    ca.OP_REMAINDER: "remainder",
    ca.OP_POW: "pow",
    ca.OP_CONSTPOW: "pow",
}


@dataclass(frozen=True)
class CBody:
    """Statements and what they end in.

    `results[k][i]` is the C expression of dense column-major element i of output k; `functions` are
    the names that `own_math.prelude` must define before.
    """

    statements: tuple[str, ...]
    results: tuple[tuple[str, ...], ...]
    functions: frozenset[str]


def literal(value: float) -> str:
    """A real constant in C; the shortest decimal that reads back to the same double."""
    if math.isfinite(value):
        return f"R({value!r})"
    # 1e999 is not a C constant; the quotient is folded by the compiler
    if math.isnan(value):
        return "(R(0.0) / R(0.0))"
    return "(R(1.0) / R(0.0))" if value > 0 else "(R(-1.0) / R(0.0))"


def emit_body(
    graph: Graph,
    name: str,
    element: Callable[[int, int], str],
    *,
    libm: bool = False,
    local: Mapping[int, str] | None = None,
    comments: Mapping[int, Sequence[str]] | None = None,
) -> CBody:
    """C statements that compute a graph.

    Args:
        graph: operations of a function, from `read_graph`.
        name: of the function, for messages.
        element: C expression of an input, `element(argument, dense column-major index)`.
        libm: whether functions beyond `own_math` may be used.
        local: names of the locals, by node; the others are t and a number.
        comments: lines above a node.

    Raises:
        InputError: an operation that the emitter does not know, or that needs the C library.
    """
    return _Writer(graph, element, name, libm, local or {}).body(comments or {})


class _Writer:
    """Walks a graph once and keeps, for each node, the C expression that stands for it."""

    def __init__(
        self,
        graph: Graph,
        element: Callable[[int, int], str],
        name: str,
        libm: bool,
        local: Mapping[int, str],
    ) -> None:
        self.graph = graph
        self.element = element
        self.name = name
        self.libm = libm
        self.local = local
        self.text: list[str] = []
        self.boolean: list[bool] = []
        self.statements: list[str] = []
        self.functions: set[str] = set()

    def body(self, comments: Mapping[int, Sequence[str]]) -> CBody:
        for index in range(len(self.graph.nodes)):
            self.statements += [f"/* {line} */" for line in comments.get(index, ())]
            self._node(index)
        results = tuple(
            tuple("R(0.0)" if i is None else self._real(i) for i in column)
            for column in self.graph.results
        )
        return CBody(tuple(self.statements), results, frozenset(self.functions))

    def _node(self, index: int) -> None:
        node = self.graph.nodes[index]
        op = node.op
        args = node.args
        if op == ca.OP_INPUT:
            self._keep(self.element(*args))
        elif op == ca.OP_CONST:
            self._keep(literal(node.value))
        elif op in (SINE_OF, COSINE_OF):
            self._keep(f"{self.text[args[0]]}.{'s' if op == SINE_OF else 'c'}")
        elif op == ca.OP_ASSIGN:
            self._keep(self.text[args[0]], self.boolean[args[0]])
        elif op == SINCOS:
            self.functions.add("sincos")
            self._declare(index, "sincos_t", f"own_sincos({self._real(args[0])})")
        elif op in _COMPARE:
            left, right = (self._real(i) for i in args)
            self._declare(index, "bool", f"{left} {_COMPARE[op]} {right}")
        elif op in _LOGIC:
            left, right = (self._truth(i) for i in args)
            self._declare(index, "bool", f"{left} {_LOGIC[op]} {right}")
        elif op == ca.OP_NOT:
            self._declare(index, "bool", f"!{self._truth(args[0])}")
        else:
            self._declare(index, "real_t", self._arithmetic(op, args))

    def _arithmetic(self, op: int, args: tuple[int, ...]) -> str:
        if op == SELECT:
            return f"{self._truth(args[0])} ? {self._real(args[1])} : {self._real(args[2])}"
        if op == ca.OP_IF_ELSE_ZERO:
            return f"{self._truth(args[0])} ? {self._real(args[1])} : R(0.0)"
        values = [self._real(i) for i in args]
        if op in _INFIX:
            return f"{values[0]} {_INFIX[op]} {values[1]}"
        if op == ca.OP_NEG:
            return f"-{values[0]}"
        if op == ca.OP_SQ:
            return f"{values[0]} * {values[0]}"
        if op == ca.OP_TWICE:
            return f"{values[0]} + {values[0]}"
        if op == ca.OP_INV:
            return f"R(1.0) / {values[0]}"
        if op in (ca.OP_POW, ca.OP_CONSTPOW):
            exponent = self.graph.nodes[args[1]]
            if (
                exponent.op == ca.OP_CONST
                and exponent.value == round(exponent.value)
                and abs(exponent.value) <= 64
            ):
                return self._integer_power(values[0], int(exponent.value))
        if op in _CALL:
            return self._call(_CALL[op], values)
        raise InputError(
            f"function {self.name!r} holds CasADi operation {op} ({len(args)} operands), which has "
            "no C form here; "
            "expected arithmetic, elementary functions, comparisons and if_else; rewrite the "
            "expression with those"
        )

    def _call(self, function: str, values: list[str]) -> str:
        if function not in own_functions() and not self.libm:
            raise InputError(
                f"function {self.name!r} uses {function}(), which the built-in mathematics does "
                "not have; "
                f'expected one of {", ".join(sorted(own_functions()))}; use math="libm" or rewrite '
                f"the expression"
            )
        self.functions.add(function)
        return f"own_{function}({', '.join(values)})"

    def _integer_power(self, base: str, exponent: int) -> str:
        """Products by repeated squaring; every partial product is a local of its own."""
        if exponent == 0:
            return "R(1.0)"
        if exponent < 0:
            return f"R(1.0) / {self._fresh(self._integer_power(base, -exponent))}"
        square = base
        product = ""
        while True:
            if exponent & 1:
                product = f"{product} * {square}" if product else square
            exponent >>= 1
            if not exponent:
                return product
            product = self._fresh(product) if " " in product else product
            square = self._fresh(f"{square} * {square}")

    def _fresh(self, expression: str) -> str:
        name = f"p{len(self.statements)}"
        self.statements.append(f"const real_t {name} = {expression};")
        return name

    def _declare(self, index: int, kind: str, expression: str) -> None:
        name = self.local.get(index, f"t{index}")
        self.statements.append(f"const {kind} {name} = {expression};")
        self._keep(name, kind == "bool")

    def _keep(self, text: str, boolean: bool = False) -> None:
        self.text.append(text)
        self.boolean.append(boolean)

    def _real(self, index: int) -> str:
        return (
            f"({self.text[index]} ? R(1.0) : R(0.0))" if self.boolean[index] else self.text[index]
        )

    def _truth(self, index: int) -> str:
        return self.text[index] if self.boolean[index] else f"({self.text[index]} != R(0.0))"
