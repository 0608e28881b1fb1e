"""Expressions of G-code: arithmetic on numbers and variables, angles in degrees."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable

from irb2400_ctrl.errors import InputError

_NUMBER = re.compile(r"\s*(\d+\.?\d*|\.\d+)")
_NAME = re.compile(r"\s*([A-Z]+2?)\s*(?=\[)")
_VARIABLE = re.compile(r"\s*(?:#\s*(\d+|<\w+>)|(R\d+)\b|([A-Z_]\w+)\b(?!\s*[\[<(]))")
EVERYWHERE: dict[str, Callable[[float], float]] = {
    "SIN": lambda x: math.sin(math.radians(x)),
    "COS": lambda x: math.cos(math.radians(x)),
    "TAN": lambda x: math.tan(math.radians(x)),
    "ASIN": lambda x: math.degrees(math.asin(x)),
    "ACOS": lambda x: math.degrees(math.acos(x)),
    "SQRT": math.sqrt,
    "ABS": abs,
}
"""functions of all controls"""
FUNCTIONS = {
    **EVERYWHERE,
    # halves go away from zero
    "ROUND": lambda x: math.copysign(math.floor(abs(x) + 0.5), x),
    "FIX": math.trunc,
    "TRUNC": math.trunc,
    "FUP": lambda x: math.copysign(math.ceil(abs(x)), x),
    "POT": lambda x: x * x,
    "EXP": math.exp,
    "LN": math.log,
}
COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "EQ": operator.eq,
    "NE": operator.ne,
    "GT": operator.gt,
    "GE": operator.ge,
    "LT": operator.lt,
    "LE": operator.le,
}
DEEPEST = 50
TURNING = frozenset(["SIN", "COS", "TAN"])
"""to which an angle and the same 360 deg larger are one"""


class Turned(float):
    """An angle below zero, which some controls of Fanuc state 360 deg larger."""


def _like(result: float, *operands: float) -> float:
    return Turned(result) if any(isinstance(value, Turned) for value in operands) else result


class Expression:
    """Reads one from a place on; `at` is where it ends."""

    POWER = "**"
    TIMES: tuple[str, ...] = ("*", "/", "MOD")

    def __init__(self, code: str, at: int, known: dict[str, float]) -> None:
        self._code = code
        self.at = at
        self.siemens = False
        """the control is one of Siemens, which calculates in one way"""
        self.in_word = False
        """the value is the number of a word such as X"""
        self._known = known
        self._depth = 0

    def sum(self) -> float:
        """Terms with + and -."""
        value = self._product()
        while sign := self._taken("+", "-"):
            other = self._product()
            value = _like(value + other if sign == "+" else value - other, value, other)
        return self._finite(lambda: value)

    def signed(self) -> float:
        """One number with its sign: a variable, a bracket, a function."""
        sign = self._taken("+", "-")
        value = self.signed() if sign else self._single()
        return _like(-value, value) if sign == "-" else value

    def bracket(self) -> float:
        """[ and ] with an expression between them."""
        self._expect("[")
        value = self._logic()
        self._expect("]")
        return value

    def _logic(self) -> float:
        """Comparisons joined by AND, OR, XOR; 1 where they hold. Without any, a sum."""
        value = self._comparison()
        joint = ""
        while word := self._taken("AND", "OR", "XOR"):
            other = self._comparison()
            if {value, other} - {0.0, 1.0} or word != (joint := joint or word):
                raise self._by_control(f"{word} of numbers, or beside {joint}")
            joined = {"AND": min(value, other), "OR": max(value, other)}
            value = joined.get(word, abs(value - other))
        return value

    def _comparison(self) -> float:
        value = self.sum()
        word = self._taken(*COMPARISONS)
        if word is None:
            return value
        return float(COMPARISONS[word](self.plain(value), self.plain(self.sum())))

    def _product(self) -> float:
        value = self._power()
        while sign := self._taken(*self.TIMES):
            value = self.plain(value)
            other = self.plain(self._power())
            if sign != "*" and other == 0:
                raise InputError(f"a division by zero in {self._code.strip()!r}")
            if sign == "MOD" and min(value, other) < 0:
                raise self._by_control("MOD of a negative number")
            results = {"*": lambda a, b: a * b, "/": lambda a, b: a / b, "MOD": math.fmod}
            value = results[sign](value, other)
        return value

    def _power(self) -> float:
        value = self.signed()
        if self._taken(self.POWER) is None:
            return value
        base = self.plain(value)
        exponent = self.plain(self.signed())
        return self._finite(lambda: base**exponent)

    def _single(self) -> float:
        self._depth += 1
        if self._depth > DEEPEST:
            raise InputError(f"brackets more than {DEEPEST} deep")
        value = self._value()
        self._depth -= 1
        return value

    def _value(self) -> float:
        if self._code.startswith("[", self._next()):
            return self.bracket()
        if found := _VARIABLE.match(self._code, self.at):
            self.at = found.end()
            return self._variable(next(name for name in found.groups() if name))
        if self._taken("#"):
            return self._variable(f"{self._single():g}")
        if found := _NUMBER.match(self._code, self.at):
            self.at = found.end()
            return float(found.group(1))
        if (found := _NAME.match(self._code, self.at)) is None:
            raise self._wrong()
        self.at = found.end()
        return self._function(found.group(1))

    def _function(self, name: str) -> float:
        self._expect("[")
        value = self.sum()
        if name not in TURNING:
            value = self.plain(value)
        if name in {"ATAN", "ATAN2"}:
            # ATAN[y]/[x] (Fanuc), ATAN2(y, x) (Siemens)
            divided = self._taken("]") is not None
            self._expect("/" if divided else ",")
            if divided:
                self._expect("[")
            angle = math.degrees(math.atan2(value, self.plain(self.sum())))
            self._expect("]")
            return self._by_range(name, angle)
        self._expect("]")
        if name not in FUNCTIONS:
            raise InputError(f"found the function {name}, which is not read")
        if name in {"FIX", "FUP"} and value < 0 and value != math.trunc(value):
            raise self._by_control(f"{name} of a negative number")
        if name == "ROUND" and self.in_word and not self.siemens and value != math.trunc(value):
            raise self._by_control(
                f"ROUND of {value:g} in a word is rounded to the smallest step by Fanuc and to a "
                "whole number by LinuxCNC"
            )
        try:
            return self._by_range(name, FUNCTIONS[name](value))
        except (ValueError, OverflowError) as error:
            raise InputError(f"{name} of {value:g}: {error}") from error

    def _by_range(self, name: str, value: float) -> float:
        """An angle below zero is one from 180 to 360 deg on some controls of Fanuc."""
        ranged = name in {"ATAN", "ASIN"} and value < 0 and not self.siemens
        return Turned(value) if ranged else value

    def plain(self, value: float) -> float:
        """The value itself.

        Raises:
            InputError: it is an angle that not all controls state so.
        """
        if isinstance(value, Turned):
            raise self._by_control(
                f"an angle of ATAN or ASIN below zero, {value:g} or {value + 360:g} deg (Fanuc), "
                "for more than SIN, COS, TAN and the words A, B, C"
            )
        return value

    def _variable(self, name: str) -> float:
        if name not in self._known:
            shown = f"#{name}" if name[0] in "0123456789<" else name
            raise InputError(
                f"found {shown}, which the file does not set before; what the "
                "control or the operator sets is not known, write the number"
            )
        return self._known[name]

    def _next(self) -> int:
        """Where the next character that is no blank stands."""
        start = self.at
        while start < len(self._code) and self._code[start].isspace():
            start += 1
        return start

    def _taken(self, *texts: str) -> str | None:
        start = self._next()
        for text in texts:
            if self._code.startswith(text, start) and not (
                text == "*" and self._code.startswith("**", start)
            ):
                self.at = start + len(text)
                return text
        return None

    def _expect(self, text: str) -> None:
        if self._taken(text) is None:
            raise self._wrong()

    def _wrong(self) -> InputError:
        rest = self._code[self.at :].strip()[:20]
        return InputError(f"found {rest!r} in an expression, expected a number, a variable or [ ]")

    def _by_control(self, what: str) -> InputError:
        return InputError(
            f"{what}, which controls calculate in different ways; expected another "
            f"way to write {self._code.strip()[:30]!r}"
        )

    def _finite(self, compute: Callable[[], float | complex]) -> float:
        try:
            value = compute()
        except (ValueError, OverflowError, ZeroDivisionError):
            value = math.nan
        if isinstance(value, complex) or not math.isfinite(value):
            raise InputError(f"{self._code.strip()!r} has no finite value")
        return value
