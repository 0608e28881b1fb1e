"""The lines of a G-code file in the order in which they are carried out, sub-programs included.

Called are M98 P… L… (Fanuc), M97 P… L… (Haas: from a block N of the program on), CALL O… Q…
(Okuma), O… CALL (LinuxCNC, with variables of its own), L100, NAME and CALL "NAME" (Siemens), where
the sub-program is in the file. A call of anything else stays in its
line, which is refused later.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.flow import COMMENT, Flow, Line
from irb2400_ctrl.planners.toolpath.readers.gcode.macros.variables import ENTER, LEAVE, Variables
from irb2400_ctrl.planners.toolpath.readers.unread_line import TooMuchError, UnreadLineError

_NUMBERED = re.compile(r"^\s*(?:/\s*)?[O:]\s*(\d+)\s*(?:$|[(<;])", re.IGNORECASE)
_ARCHIVE = re.compile(r"^\s*%_N_(\w+)_(MPF|SPF)\b", re.IGNORECASE)
_SUB = re.compile(r"^\s*O\s*(\d+|<[^<>]+>)\s+SUB\b", re.IGNORECASE)
_END_SUB = re.compile(r"^\s*O\s*(\d+|<[^<>]+>)\s+ENDSUB\b", re.IGNORECASE)
_M98 = re.compile(r"M0*9[78](?!\d)", re.IGNORECASE)
_M97 = re.compile(r"M0*97(?!\d)", re.IGNORECASE)
# how often, where that is no number
_COUNTED = re.compile(r"[LK]\s*(#\s*\d+|#?<[^<>]+>|#?\[.*\])", re.IGNORECASE)
_ENDS = re.compile(r"M0*(?:2|30)(?!\d)", re.IGNORECASE)
_P = re.compile(r"P\s*(\d+)", re.IGNORECASE)
_L = re.compile(r"[LK]\s*(\d+)", re.IGNORECASE)
_FROM_BLOCK = re.compile(r"[QH]\s*\d", re.IGNORECASE)
# the H behind G43 is the register of the tool's length; one behind M98 may be a block
_LENGTH_OFFSET = re.compile(
    r"G\s*0*43(?:\.[145])?(?![\d.])(?:(?!M\s*0*98(?!\d)).)*?H\s*\d+", re.IGNORECASE
)
# a cycle with steps or a way aside: its Q is none of M98
_CYCLE_Q = re.compile(r"(G\s*0*(?:73|76|83|87)(?![\d.]).*?)Q\s*[-+]?[\d.]+", re.IGNORECASE)
_O_CALL = re.compile(r"^\s*O\s*(\d+|<[^<>]+>)\s+CALL\b(.*)", re.IGNORECASE)
_NAMED = re.compile(
    r'^\s*(?:N\d+\s*)?(?:CALL\s+"(\w+)"|([A-Z_]\w+))\s*(?:P\s*=?\s*(\d+))?\s*$', re.IGNORECASE
)
_OKUMA = re.compile(r"^\s*CALL\s+O(\d+)\s*(?:Q\s*(\d+))?\s*$", re.IGNORECASE)
_RETURN = re.compile(r"M0*(?:99|17)(?!\d)|\b(?:RET|RTS)\b", re.IGNORECASE)
_NUMBER = re.compile(r"\s*N\s*(\d+)", re.IGNORECASE)
_BLOCK = ":N"
"""between the name of a program and the number of a block that M97 calls"""
# nothing, the mark of a tape, the name of a program (Okuma)
_EMPTY = re.compile(r"%?|\$[\w.-]+%")
DEEPEST = 10
MOST_LINES = 2_000_000


@dataclass
class _Programs:
    """Lines by the name of their program, in the order of the file."""

    lines: dict[str, list[Line]] = field(default_factory=dict)
    main: str = ""

    def named(self, name: str) -> str | None:
        """The program of this name or number, as it is kept here."""
        key = name.upper().lstrip("0") or "0"
        return key if key in self.lines else None


def in_order(
    text: str, name: str, variables: Variables
) -> tuple[Iterator[Line | UnreadLineError], list[Line]]:
    """Lines with their numbers as the control carries them out, and what is to be noted.

    Args:
        text: of the file.
        name: of the file, for messages.
        variables: which who takes the lines one by one sets; loops and conditions ask them.

    Raises:
        InputError: no program begins; while the lines are gone through, TooMuchError: calls
            within calls without an end.
    """
    listed = list(enumerate(text.split("\n"), 1))
    programs = _parted(listed)
    called = {
        target for name, lines in programs.lines.items() for _, raw in lines
        if (target := (_call(raw, programs, name) or ("",))[0])
    }  # fmt: skip
    if not called:
        return Flow(listed, variables).lines(), []
    free = [key for key in programs.lines if key not in called and programs.lines[key]]
    if not free:
        raise InputError(
            f"{name}: each of its programs is called by one of them, none begins; expected a main "
            "program that calls them"
        )
    first = programs.main if programs.main in free else free[0]
    notes = [
        (programs.lines[key][0][0], f"program {key} is called by no other: it is left out")
        for key in free
        if key != first
    ]
    notes += [
        (number, f"{_code(raw)}: the sub-program is called no times: its moves are left out")
        for name, lines in programs.lines.items() if _BLOCK not in name for number, raw in lines
        if (found := _call(raw, programs, name)) is not None and found[1] == 0
    ]  # fmt: skip
    return _Runner(programs, variables).run(first, 0), notes


def _parted(listed: list[Line]) -> _Programs:
    programs = _Programs()
    current = ""
    programs.lines[current] = []
    for number, raw in listed:
        archive = _ARCHIVE.match(raw)
        begins = _NUMBERED.match(raw) or archive or _SUB.match(raw)
        if begins:
            current = begins.group(1).upper().lstrip("0") or "0"
            programs.lines.setdefault(current, [])
            if archive and archive.group(2).upper() == "MPF":
                programs.main = current
        else:
            programs.lines[current].append((number, raw))
            if _END_SUB.match(raw):
                current = ""
    head = programs.lines[""]
    if all(_EMPTY.fullmatch(_code(raw)) for _, raw in head):
        del programs.lines[""]
    _with_blocks(programs)
    return programs


def _code(raw: str) -> str:
    return COMMENT.sub(" ", raw).strip()


def _with_blocks(programs: _Programs) -> None:
    """Adds what M97 P5 calls, the block N5 of its own program and what follows; behind the end of
    the program nothing else carries it out."""
    for name, lines in list(programs.lines.items()):
        codes = [_code(raw) for _, raw in lines]
        wanted = {
            p[1].lstrip("0") for code in codes if _M97.search(code) and (p := _P.search(code))
        }
        end = next((at for at, code in enumerate(codes) if _ENDS.search(code)), len(codes))
        called = set()
        for at, code in enumerate(codes):
            block = _NUMBER.match(code)
            if block is None or block[1].lstrip("0") not in wanted:
                continue
            programs.lines.setdefault(f"{name}{_BLOCK}{block[1].lstrip('0')}", lines[at:])
            stop = next((i for i in range(at, len(codes)) if _RETURN.search(codes[i])), at)
            called |= set(range(at, stop + 1)) if at > end else set()
        programs.lines[name] = [line for at, line in enumerate(lines) if at not in called]


def _call(raw: str, programs: _Programs, name: str) -> tuple[str, int, str, str] | None:
    """Which program a line calls, how often, what is left of the line, and arguments; None where
    it calls none of this file.

    Args:
        raw: the line; programs: of the file; name: of the one that the line is in.
    """
    code = _code(raw)
    if _M98.search(code):
        p = _P.search(code)
        times = _L.search(code)
        # P2 Q10, P2 H10: from a block of it on
        others = _CYCLE_Q.sub(r"\1", _LENGTH_OFFSET.sub("", code, count=1), count=1)
        if p is None or _FROM_BLOCK.search(others) or (times and _CYCLE_Q.search(code)):
            return None
        block = f"{name.split(_BLOCK)[0]}{_BLOCK}{p[1].lstrip('0')}"
        target = programs.named(block if _M97.search(code) else p[1])
        count = int(times[1]) if times else 1
        if target is None and times is None and len(p[1]) > 4:
            # Fanuc: P and eight digits, how often and which
            target = programs.named(p[1][-4:])
            count = int(p[1][:-4])
        rest = _M98.sub("", _P.sub("", _L.sub("", code, count=1), count=1), count=1)
        return None if target is None else (target, count, rest, "")
    if found := _O_CALL.match(code):
        target = programs.named(found[1])
        return None if target is None else (target, 1, "", found[2])
    if found := _OKUMA.match(code):
        target = programs.named(found[1])
        return None if target is None else (target, int(found[2] or 1), "", "")
    found = _NAMED.match(code)
    if found is None:
        return None
    target = programs.named(found[1] or found[2])
    return None if target is None else (target, int(found[3] or 1), "", "")


class _Runner:
    """Goes through a program and those that it calls."""

    def __init__(self, programs: _Programs, variables: Variables) -> None:
        self._programs = programs
        self._variables = variables
        self._count = 0

    def run(self, name: str, depth: int) -> Iterator[Line | UnreadLineError]:
        """The lines of a program and of those that it calls."""
        for line in Flow(self._programs.lines[name], self._variables).lines():
            if isinstance(line, UnreadLineError):
                yield line
                continue
            number, raw = line
            self._count += 1
            if depth > DEEPEST or self._count > MOST_LINES:
                raise TooMuchError(
                    number,
                    f"calls of sub-programs more than {DEEPEST} deep, or more than "
                    f"{MOST_LINES:,} lines in all; expected calls that end",
                )
            code = _code(raw)
            if _END_SUB.match(code):
                return
            if depth and _RETURN.search(code):
                rest = _RETURN.sub("", code)
                # back to another line than that of the call
                yield number, f"GOTO {rest.strip()}" if _P.search(rest) else rest
                return
            if depth and code == "%":
                # that of the whole file, of which a sub-program is the last
                continue
            try:
                call = _call(self._counted(raw), self._programs, name)
            except InputError as error:
                yield UnreadLineError(number, str(error))
                continue
            if call is None:
                yield number, raw
                continue
            target, times, rest, arguments = call
            yield number, rest
            own = _O_CALL.match(code) is not None
            if own:
                yield number, f"{ENTER}{arguments}"
            for _ in range(times):
                yield from self.run(target, depth + 1)
            if own:
                yield number, LEAVE

    def _counted(self, raw: str) -> str:
        """The line with the number in the place of an expression that says how often: L#25."""
        code = _code(raw)
        found = _COUNTED.search(code) if _M98.search(code) else None
        if found is None:
            return raw
        times = self._variables.value(found[1].upper())
        if times != int(times) or not 0 <= times <= MOST_LINES:
            raise InputError(f"found {found[0]} of {times:g}, expected a whole number of times")
        return code.replace(found[0], f"L{int(times)}")
