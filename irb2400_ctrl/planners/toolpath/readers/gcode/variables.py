"""Variables of G-code that a file sets for itself: #100 (Fanuc, LinuxCNC), R1 and those that
`DEF REAL _F_CUT` names (Siemens).

Assignments and arithmetic; angles in degrees. What a file does not set, the control knows: refused.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable

from irb2400_ctrl.errors import InputError

# between the lines: a program of LinuxCNC begins, with its arguments, and ends; no text has a zero
ENTER = "\0enter "
LEAVE = "\0leave"
_NUMBER = re.compile(r"\s*(\d+\.?\d*|\.\d+)")
_NAME = re.compile(r"\s*([A-Z]+2?)\s*(?=\[)")
_SET = re.compile(r"\s*(?:N\d+\s*)?(?:#\s*(\d+|<\w+>)|(R\d+))\s*=(?!=)")
_DEFINED = re.compile(
    r"\s*(?:N\d+\s*)?DEF\s+(?:REAL|INT|BOOL|CHAR|STRING\s*\[\s*\d+\s*\])\s+(?=[A-Z_])"
)
_NAME_SET = re.compile(r"\s*(?:N\d+\s*)?([A-Z_]\w*)\s*=(?!=)")
_EQUALS_NAME = re.compile(r"([A-Z][A-Z0-9]*)\s*=\s*(?=[-+*/\d.\s]*([A-Z_]\w+))")
_FLOW = re.compile(r"\b(WHILE|IF|GOTO[FBCS]?|DO\s*\d|END\s*\d?|FOR|LOOP|REPEAT|UNTIL|ELSE)\b")
# a word whose number is a variable or an expression: X#1, X-[#1+2], X=R1*2, CR=R5
_WORD = re.compile(r"([A-Z](?:R(?==)|\d(?==))?)\s*(=?)\s*(?=[-+]?\s*(?:#|\[))")
_EQUALS = re.compile(r"([A-Z][A-Z0-9]*)\s*=\s*(?=[^=]*(?:\bR\d|\[|[-+*/]\s*[\d.(]))")
FUNCTIONS: dict[str, Callable[[float], float]] = {
    "SIN": lambda x: math.sin(math.radians(x)),
    "COS": lambda x: math.cos(math.radians(x)),
    "TAN": lambda x: math.tan(math.radians(x)),
    "ASIN": lambda x: math.degrees(math.asin(x)),
    "ACOS": lambda x: math.degrees(math.acos(x)),
    "SQRT": math.sqrt,
    "ABS": abs,
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
# what each sub-program of LinuxCNC has for itself
_LOCAL = re.compile(r"[1-9]|[12]\d|30|<[^_]\w*>")
MOST_ARGUMENTS = 30
DEEPEST = 50


_VARIABLE = re.compile(r"\s*(?:#\s*(\d+|<\w+>)|(R\d+)\b|([A-Z_]\w+)\b(?!\s*[\[<(]))")


class Variables:
    """What the file has set so far."""

    def __init__(self) -> None:
        self._known: dict[str, float] = {}
        self._callers: list[dict[str, float]] = []
        self._names: set[str] = set()
        """those that DEF states"""

    def scope(self, order: str, place: str) -> None:
        """A sub-program of LinuxCNC begins, with its arguments as #1 … #30, or ends: those and
        #<names> without _ are its own, and the caller's come back.

        Args:
            order: `ENTER` with `[…][…]` behind it, or `LEAVE`.
            place: for messages.

        Raises:
            InputError: an argument that is no expression.
        """
        own = {name for name in self._known if _LOCAL.fullmatch(name)}
        shared = {name: value for name, value in self._known.items() if name not in own}
        if order == LEAVE:
            self._known = shared | self._callers.pop()
            return
        self._callers.append({name: self._known[name] for name in own})
        given = self._arguments(order.removeprefix(ENTER).upper(), place)
        given += [0.0] * (MOST_ARGUMENTS - len(given))
        self._known = shared | {str(number): value for number, value in enumerate(given, 1)}

    def value(self, code: str, place: str) -> float:
        """An expression, such as a condition in brackets: 1 where it holds.

        Args:
            code: upper case, without comments.
            place: for messages.

        Raises:
            InputError: a variable that is not set, or no expression.
        """
        reader = _Expression(code, 0, self._known, place)
        found = reader.signed()
        if code[reader.at :].strip():
            raise InputError(f"{place}: found {code.strip()[:30]!r}, expected one condition")
        return found

    def _arguments(self, code: str, place: str) -> list[float]:
        found = []
        at = 0
        while code[at:].strip():
            reader = _Expression(code, at, self._known, place)
            found.append(reader.bracket())
            at = reader.at
        return found

    def resolve(self, code: str, place: str) -> str:
        """The code of a line with numbers in the place of variables; assignments are kept and taken
        out.

        Args:
            code: upper case, without comments.
            place: for messages.

        Raises:
            InputError: a variable that is not set, an expression that is none.
        """
        if defined := _DEFINED.match(code):
            return self._define(code[defined.end() :], place)
        if not ("#" in code or "[" in code or "=" in code) or _FLOW.search(code):
            return code
        if "<_HAL[" in code:
            raise InputError(
                f"{place}: found #<_hal[…]>, a value of the control, which is not in the file; "
                "write the number"
            )
        code = self._assigned(code, place)
        out = ""
        at = 0
        while at < len(code):
            # letters are words of their own here, so that R in X1R5 is none of a variable
            word = _WORD.match(code, at)
            equals = None if word else _EQUALS.match(code, at) or self._with_name(code, at)
            found = word or equals
            if found is None or (equals and re.match(r"\s*[ADI]C\s*[\[(]", code[equals.end() :])):
                out += code[at]
                at += 1
                continue
            reader = _Expression(code, found.end(), self._known, place)
            value = reader.sum() if equals or found.group(2) else reader.signed()
            out += f"{found.group(1)}{'=' if equals or found.group(2) else ''}{value:.12f} "
            at = reader.at
        return out

    def _assigned(self, code: str, place: str) -> str:
        while found := _SET.match(code) or self._name_set(code):
            reader = _Expression(code, found.end(), self._known, place)
            name = next(name for name in found.groups() if name)
            self._known[name] = reader.sum()
            code = code[reader.at :]
            if re.search(rf"#\s*{name}(?!\d)", code):
                raise InputError(
                    f"{place}: #{name} is set and used in one block, where some controls take the "
                    "value from before it; expected two blocks"
                )
        return code

    def _name_set(self, code: str) -> re.Match[str] | None:
        found = _NAME_SET.match(code)
        return found if found and found.group(1) in self._names else None

    def _with_name(self, code: str, at: int) -> re.Match[str] | None:
        found = _EQUALS_NAME.match(code, at) if self._names else None
        return found if found and found.group(2) in self._names else None

    def _define(self, text: str, place: str) -> str:
        """DEF REAL a, b=2: what is set is kept, the others are not known yet."""
        for part in text.split(","):
            name, equals, _ = part.partition("=")
            self._names.add(name.strip())
            if equals:
                self._assigned(part, place)
        return ""


class _Expression:
    """Reads one from a place on; `at` is where it ends."""

    def __init__(self, code: str, at: int, known: dict[str, float], place: str) -> None:
        self._code = code
        self.at = at
        self._known = known
        self._place = place
        self._depth = 0

    def sum(self) -> float:
        """Terms with + and -."""
        value = self._product()
        while sign := self._taken("+", "-"):
            other = self._product()
            value = value + other if sign == "+" else value - other
        return self._finite(value)

    def signed(self) -> float:
        """One number with its sign: a variable, a bracket, a function."""
        sign = self._taken("+", "-")
        value = self.signed() if sign else self._single()
        return -value if sign == "-" else value

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
        return float(COMPARISONS[word](value, self.sum())) if word else value

    def _product(self) -> float:
        value = self._power()
        while sign := self._taken("*", "/", "MOD"):
            other = self._power()
            if sign != "*" and other == 0:
                raise InputError(f"{self._place}: a division by zero in {self._code.strip()!r}")
            if sign == "MOD" and min(value, other) < 0:
                raise self._by_control("MOD of a negative number")
            results = {"*": lambda a, b: a * b, "/": lambda a, b: a / b, "MOD": math.fmod}
            value = results[sign](value, other)
        return value

    def _power(self) -> float:
        value = self.signed()
        return self._finite(value ** self.signed()) if self._taken("**") else value

    def _single(self) -> float:
        self._depth += 1
        if self._depth > DEEPEST:
            raise InputError(f"{self._place}: brackets more than {DEEPEST} deep")
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
        if name in {"ATAN", "ATAN2"}:
            # ATAN[y]/[x] (Fanuc), ATAN2(y, x) (Siemens)
            divided = self._taken("]") is not None
            self._expect("/" if divided else ",")
            if divided:
                self._expect("[")
            angle = math.degrees(math.atan2(value, self.sum()))
            self._expect("]")
            return angle
        self._expect("]")
        if name not in FUNCTIONS:
            raise InputError(f"{self._place}: found the function {name}, which is not read")
        if name in {"FIX", "FUP"} and value < 0 and value != math.trunc(value):
            raise self._by_control(f"{name} of a negative number")
        try:
            return FUNCTIONS[name](value)
        except (ValueError, OverflowError) as error:
            raise InputError(f"{self._place}: {name} of {value:g}: {error}") from error

    def _variable(self, name: str) -> float:
        if name not in self._known:
            shown = f"#{name}" if name[0] in "0123456789<" else name
            raise InputError(
                f"{self._place}: found {shown}, which the file does not set before; what the "
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
        return InputError(
            f"{self._place}: found {rest!r} in an expression, expected a number, a variable or [ ]"
        )

    def _by_control(self, what: str) -> InputError:
        return InputError(
            f"{self._place}: {what}, which controls calculate in different ways; expected another "
            f"way to write {self._code.strip()[:30]!r}"
        )

    def _finite(self, value: float | complex) -> float:
        if isinstance(value, complex) or not math.isfinite(value):
            raise InputError(f"{self._place}: {self._code.strip()!r} has no finite value")
        return value
