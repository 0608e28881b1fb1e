"""Variables of G-code that a file sets for itself: #100 (Fanuc, LinuxCNC), R1 and those that
`DEF REAL _F_CUT` names (Siemens).

Assignments and arithmetic; angles in degrees. What a file does not set, the control knows: refused.
"""

from __future__ import annotations

import re

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.macros.expressions import Expression
from irb2400_ctrl.planners.toolpath.readers.gcode.state import ROTARY

# between the lines: a program of LinuxCNC begins, with its arguments, and ends; no text has a zero
ENTER = "\0enter "
LEAVE = "\0leave"
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
# what each sub-program of LinuxCNC has for itself
_LOCAL = re.compile(r"[1-9]|[12]\d|30|<[^_]\w*>")
MOST_ARGUMENTS = 30
_OFFSETS = (
    "moves a zero of the control (G54 to G59, G52, G92; where it only says before the first motion "
    "where the part lies on the machine, delete the line)"
)
_ALARMS = {
    3000: "stops the program with an alarm (Fanuc): what is behind it is not carried out",
    3006: "waits for the operator (Fanuc); write M0",
    3007: "mirrors (Fanuc)",
}


class Variables:
    """What the file has set so far."""

    def __init__(self, *, siemens: bool = False, linuxcnc: bool = False) -> None:
        self.lost = False
        """a line could not be read: what it sets is not known, and a loop may wait for it"""
        self._siemens = siemens
        self._linuxcnc = linuxcnc
        self._known: dict[str, float] = {}
        self._callers: list[dict[str, float]] = []
        self._names: set[str] = set()
        """those that DEF states"""

    def scope(self, order: str) -> None:
        """A sub-program of LinuxCNC begins, with its arguments as #1 … #30, or ends: those and
        #<names> without _ are its own, and the caller's come back.

        Args:
            order: `ENTER` with `[…][…]` behind it, or `LEAVE`.

        Raises:
            InputError: an argument that is no expression.
        """
        own = {name for name in self._known if _LOCAL.fullmatch(name)}
        shared = {name: value for name, value in self._known.items() if name not in own}
        if order == LEAVE:
            self._known = shared | self._callers.pop()
            return
        self._callers.append({name: self._known[name] for name in own})
        given = self._arguments(order.removeprefix(ENTER).upper())
        given += [0.0] * (MOST_ARGUMENTS - len(given))
        self._known = shared | {str(number): value for number, value in enumerate(given, 1)}

    def value(self, code: str) -> float:
        """An expression, such as a condition in brackets: 1 where it holds.

        Args:
            code: upper case, without comments.

        Raises:
            InputError: a variable that is not set, or no expression.
        """
        reader = self._expression(code, 0)
        found = reader.signed()
        if code[reader.at :].strip():
            raise InputError(f"found {code.strip()[:30]!r}, expected one condition")
        return found

    def _expression(self, code: str, at: int) -> Expression:
        found = Expression(code, at, self._known)
        found.siemens = self._siemens
        return found

    def _arguments(self, code: str) -> list[float]:
        found = []
        at = 0
        while code[at:].strip():
            reader = self._expression(code, at)
            found.append(reader.bracket())
            at = reader.at
        return found

    def resolve(self, code: str) -> str:
        """The code of a line with numbers in the place of variables; assignments are kept and taken
        out.

        Args:
            code: upper case, without comments.

        Raises:
            InputError: a variable that is not set, an expression that is none.
        """
        if defined := _DEFINED.match(code):
            return self._define(code[defined.end() :])
        if not ("#" in code or "[" in code or "=" in code) or _FLOW.search(code):
            return code
        if "<_HAL[" in code:
            raise InputError(
                "found #<_hal[…]>, a value of the control, which is not in the file; "
                "write the number"
            )
        code = self._assigned(code)
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
            reader = self._expression(code, found.end())
            reader.in_word = True
            value = reader.sum() if equals or found.group(2) else reader.signed()
            if found.group(1) not in ROTARY:
                reader.plain(value)
            out += f"{found.group(1)}{'=' if equals or found.group(2) else ''}{value:.12f} "
            at = reader.at
        return out

    def _assigned(self, code: str) -> str:
        while found := _SET.match(code) or self._name_set(code):
            reader = self._expression(code, found.end())
            name = next(name for name in found.groups() if name)
            if name.isdecimal() and (acts := self._acts(int(name))):
                raise InputError(f"#{name}= {acts}; not read")
            self._known[name] = reader.sum()
            code = code[reader.at :]
            if re.search(rf"#\s*{name}(?!\d)", code):
                raise InputError(
                    f"#{name} is set and used in one block, where some controls take the "
                    "value from before it; expected two blocks"
                )
        return code

    def _acts(self, number: int) -> str:
        """What setting this variable does on the control; empty where it only keeps a value."""
        if 5201 <= number < 5400 or (7001 <= number < 7960 and not self._linuxcnc):
            return _OFFSETS
        return "" if self._linuxcnc else _ALARMS.get(number, "")

    def _name_set(self, code: str) -> re.Match[str] | None:
        found = _NAME_SET.match(code)
        return found if found and found.group(1) in self._names else None

    def _with_name(self, code: str, at: int) -> re.Match[str] | None:
        found = _EQUALS_NAME.match(code, at) if self._names else None
        return found if found and found.group(2) in self._names else None

    def _define(self, text: str) -> str:
        """DEF REAL a, b=2: what is set is kept, the others are not known yet."""
        for part in text.split(","):
            name, equals, _ = part.partition("=")
            self._names.add(name.strip())
            if equals:
                self._assigned(part)
        return ""
