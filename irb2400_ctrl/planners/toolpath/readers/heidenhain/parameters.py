"""Q parameters of Heidenhain's plain language: `FN 0: Q1 = +5`, `Q2 = Q1 * COS Q3`; angles in
degrees. What the file does not set, the control knows: refused."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.macros.expressions import EVERYWHERE, Expression

_FN = re.compile(r"^FN\s*(\d+)\s*:\s*(.*)$")
_SET = re.compile(r"^(Q[LR]?\d+)\s*=\s*(.*)$")
_USED = re.compile(r"([-+]?)\s*(Q[LR]?\d+)\b(?!\s*=)")
_TOKEN = re.compile(r"\s*(\d+\.?\d*|\.\d+|Q[LR]?\d+|[A-Z]+|[-+*/^()])")
ARITHMETIC = range(8)
"""of FN: assign, add, subtract, multiply, divide, root, sine, cosine"""
QUIET_FN = frozenset([14, 16, 20, 38])
"""messages, lists, waiting: nothing for the points"""
PLANE_ANGLES = frozenset(("Q120", "Q121", "Q122"))
"""where the control puts the angles of A, B, C of a tilted plane"""
FUNCTIONS: dict[str, Callable[[float], float]] = {
    **EVERYWHERE,
    "ATAN": lambda x: math.degrees(math.atan(x)),
    "SQ": lambda x: x * x,
    "INT": math.trunc,
    "FRAC": lambda x: x - math.trunc(x),
    "NEG": lambda x: -x,
    "SGN": lambda x: float((x > 0) - (x < 0)),
    "LN": math.log,
    "LOG": math.log10,
    "EXP": math.exp,
}
COMPARISONS: dict[int, Callable[[float, float], bool]] = {
    9: lambda a, b: a == b,
    10: lambda a, b: a != b,
    11: lambda a, b: a > b,
    12: lambda a, b: a < b,
}
DEEPEST = 50


class Parameters:
    """What the file has set so far."""

    def __init__(self) -> None:
        self._known: dict[str, float] = {}

    def resolve(self, code: str) -> str:
        """A block with numbers in the place of parameters.

        Raises:
            InputError: one that the file has not set.
        """

        def number(found: re.Match[str]) -> str:
            if found[2] in PLANE_ANGLES and found[2] not in self._known:
                return found[0]
            value = self.value(found[2])
            return f"{-value if found[1] == '-' else value:+.9f}"

        return _USED.sub(number, code)

    def value(self, name: str) -> float:
        """What the file has set it to."""
        if name not in self._known:
            raise InputError(
                f"found {name}, which the file does not set before; what the control or "
                "the operator sets is not known, write the number"
            )
        return self._known[name]

    def assign(self, code: str) -> bool:
        """Carry out a block that sets a parameter; whether it is one.

        Raises:
            InputError: an expression that is none, or a function that asks the control.
        """
        numbered = _FN.match(code)
        found = _SET.match(numbered[2] if numbered else code)
        if numbered is None and found is None:
            return False
        if numbered and int(numbered[1]) in QUIET_FN:
            return True
        if found is None or (numbered and int(numbered[1]) not in ARITHMETIC):
            raise InputError(
                f"{code[:30]!r} asks or tells the control; of FN 0 to 7 and 9 to 12 and "
                "formulas are read: let the CAM system write numbers"
            )
        self._known[found[1]] = self.expression(found[2].replace("DIV", "/"))
        return True

    def expression(self, text: str) -> float:
        """The value of a formula."""
        return _Formula(text, self).value()


class _Formula(Expression):
    """Reads one."""

    POWER = "^"
    TIMES = ("*", "/")

    def __init__(self, text: str, parameters: Parameters) -> None:
        super().__init__(text, 0, {})
        self._parameters = parameters
        self._tokens: list[str] = []
        at = 0
        while text[at:].strip():
            token = _TOKEN.match(text, at)
            if token is None:
                raise self._wrong()
            self._tokens.append(token[1])
            at = token.end()

    def value(self) -> float:
        """All of it."""
        found = self.sum()
        if self._tokens:
            raise self._wrong()
        return found

    def signed(self) -> float:
        self._depth += 1
        token = self._take()
        if self._depth > DEEPEST:
            raise self._wrong()
        if token in {"+", "-"}:
            value = self.signed()
            value = -value if token == "-" else value
        elif token == "(":
            value = self.sum()
            if self._take() != ")":
                raise self._wrong()
        elif token in FUNCTIONS:
            argument = self.signed()
            value = self._finite(lambda: FUNCTIONS[token](argument))
        elif token == "PI":
            value = math.pi
        elif token[0] == "Q" and token[-1].isdigit():
            value = self._parameters.value(token)
        elif token[0] in ".0123456789":
            value = float(token)
        else:
            raise self._wrong()
        self._depth -= 1
        return value

    def _taken(self, *texts: str) -> str | None:
        return self._take() if self._tokens and self._tokens[0] in texts else None

    def _take(self) -> str:
        if not self._tokens:
            raise self._wrong()
        return self._tokens.pop(0)

    def _wrong(self) -> InputError:
        return InputError(
            f"{self._code.strip()[:30]!r} is no formula that is read; expected "
            "numbers, Q parameters, + - * / ^, brackets and functions such as COS"
        )
