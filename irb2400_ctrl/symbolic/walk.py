"""A CasADi function evaluated in any algebra: intervals, complex discs, arrays, nodes of C code.

A `casadi.Function` of SX is a list of operations on scalars. `walk` goes through it once; what a
number is, and what the operations do with it, is the `Algebra`'s.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, Generic, TypeVar

import casadi as ca

from irb2400_ctrl.errors import InputError

T = TypeVar("T")

_NAMES = {
    getattr(ca, name): name.removeprefix("OP_").lower() for name in dir(ca) if name[:3] == "OP_"
}


class NoRule(Exception):
    """Raised by a rule for operands that it has no result for; `walk` turns it into an
    InputError."""

    def __init__(self, op: int) -> None:
        super().__init__(op)
        self.op = op


class Algebra(ABC, Generic[T]):
    """A kind of numbers, T, and how CasADi's operations act on them."""

    expected = "expected another function"
    """what a message about an operation without a rule ends in"""

    @abstractmethod
    def constant(self, value: float) -> T:
        """A constant of the function as such a number."""

    @abstractmethod
    def rule(self, op: int) -> Callable[..., T] | None:
        """What the operation `op` (`casadi.OP_ADD` …) does with its one or two operands; None when
        the algebra does not know it.

        The rule may raise `NoRule(op)` for some operands.
        """


_Step = tuple[int, Callable[..., Any] | None, int, int, int, float]
"""One instruction: operation, rule, first, second, place, constant. The three numbers name places
of the work vector, but input: first, second are argument and element; output: place, second are."""


class Walk(Generic[T]):
    """The operations of a function bound to an algebra, to be evaluated many times."""

    def __init__(self, function: ca.Function, algebra: Algebra[T]) -> None:
        """Read the instructions.

        Raises:
            InputError: no function of plain operations, or an operation without a rule.
        """
        function = as_sx(function)
        self.name = function.name()
        self.algebra = algebra
        self._sizes = [function.nnz_out(k) for k in range(function.n_out())]
        self._places = function.sz_w()
        self._rules: dict[int, Callable[..., T]] = {}
        self._steps = [self._step(function, k) for k in range(function.n_instructions())]

    def _step(self, function: ca.Function, k: int) -> _Step:
        op = function.instruction_id(k)
        operands = function.instruction_input(k)
        target = function.instruction_output(k)
        if op == ca.OP_INPUT:
            return op, None, operands[0], operands[1], target[0], 0.0
        if op == ca.OP_CONST:
            return op, None, 0, 0, target[0], float(function.instruction_constant(k))
        if op == ca.OP_OUTPUT:
            return op, None, operands[0], target[1], target[0], 0.0
        if op == ca.OP_CALL:
            raise InputError(
                f"function {self.name!r} calls another function inside; expected plain operations; "
                "call the inner function with inlining (the default) or expand it first"
            )
        if op not in self._rules:
            rule = self.algebra.rule(op)
            if rule is None:
                raise self._refused(op)
            self._rules[op] = rule
        second = operands[1] if len(operands) == 2 else -1
        return op, self._rules[op], operands[0], second, target[0], 0.0

    def __call__(self, arguments: Callable[[int, int], T]) -> list[list[T]]:
        """The structural nonzeros of every output.

        Args:
            arguments: (number of the input, number of the nonzero in it) -> its value; asked for
                when it is needed, in the order of the instructions.

        Raises:
            InputError: an operation without a rule for its operands.
        """
        work: list[Any] = [None] * self._places
        results: list[list[Any]] = [[None] * size for size in self._sizes]
        constant = self.algebra.constant
        try:
            for op, rule, first, second, place, value in self._steps:
                if rule is not None:
                    work[place] = (
                        rule(work[first]) if second < 0 else rule(work[first], work[second])
                    )
                elif op == ca.OP_INPUT:
                    work[place] = arguments(first, second)
                elif op == ca.OP_CONST:
                    work[place] = constant(value)
                else:
                    results[place][second] = work[first]
        except NoRule as refused:
            raise self._refused(refused.op) from refused
        return results

    def _refused(self, op: int) -> InputError:
        """The message about an operation without a rule."""
        return InputError(
            f"{self.name}: the operation {_NAMES[op]!r} has no rule here; {self.algebra.expected}"
        )


def walk(
    function: ca.Function, algebra: Algebra[T], arguments: Callable[[int, int], T]
) -> list[list[T]]:
    """A function's value in an algebra: the structural nonzeros of every output.

    Args:
        function: of SX, or one that can be expanded into it.
        algebra: what its operations do.
        arguments: (number of the input, number of the nonzero in it) -> its value.

    Raises:
        InputError: no function of plain operations, or an operation without a rule.
    """
    return Walk(function, algebra)(arguments)


def as_sx(fn: ca.Function) -> ca.Function:
    """`fn` itself when made of SX, else its expansion.

    Raises:
        InputError: the function cannot be expanded into scalar operations, or has free variables.
    """
    if fn.is_a("SXFunction"):
        expanded = fn
    else:
        try:
            expanded = fn.expand()
        except RuntimeError as error:
            raise InputError(
                f"function {fn.name()!r} cannot be expanded into scalar operations; expected an SX "
                "function "
                "(no solvers, lookups or callbacks inside); build it from ca.SX symbols"
            ) from error
    if expanded.has_free():
        raise InputError(
            f"function {fn.name()!r} has free variables {expanded.get_free()}; "
            "every symbol must be an input: add them to the inputs or substitute numbers"
        )
    return expanded
