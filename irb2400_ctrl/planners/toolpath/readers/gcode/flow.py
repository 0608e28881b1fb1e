"""Loops and conditions of G-code, as far as what they ask is set by the file: WHILE … DO1, IF …
GOTO, IF … THEN (Fanuc), o100 while, do, repeat, if (LinuxCNC).

The lines are given out one by one, so that a condition finds the variables as the lines before it
have set them.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.macros.variables import Variables
from irb2400_ctrl.planners.toolpath.readers.unread_line import TooMuchError, UnreadLineError

Line = tuple[int, str]
_O_WORD = re.compile(
    r"^\s*(?:N\d+\s*)?O\s*(\d+|<[^<>]+>)\s+"
    r"(WHILE|ENDWHILE|DO|IF|ELSEIF|ELSE|ENDIF|REPEAT|ENDREPEAT|BREAK|CONTINUE)\b(.*)$",
    re.IGNORECASE,
)
_WHILE = re.compile(r"^\s*(?:N\d+\s*)?WHILE\s*(\[.*\])\s*DO\s*(\d+)\s*$", re.IGNORECASE)
_END = re.compile(r"^\s*(?:N\d+\s*)?END\s*(\d+)\s*$", re.IGNORECASE)
_GOTO = re.compile(
    r"^\s*(?:N\d+\s*)?(?:IF\s*(\[.*\])\s*)?GOTO\s*(\d+|#\d+|\[.*\])\s*$", re.IGNORECASE
)
_PROGRAM = re.compile(r"[O:]\s*\d+\s*$")
_BLOCK = re.compile(r"N\s*(\d+)")
_THEN = re.compile(r"^\s*(?:N\d+\s*)?IF\s*(\[.*\])\s*THEN\s*(#.*)$", re.IGNORECASE)
_PROGRAM_END = re.compile(r"(?<![A-Z])M\s*0*(?:2|30|99)(?!\d)", re.IGNORECASE)
COMMENT = re.compile(r"\([^()]*\)|;.*|^\s*//.*")
MOST_LINES = 300_000
"""that loops and jumps carry out again"""


@dataclass
class _Word:
    """A line with an o-word."""

    label: str
    kind: str
    rest: str


class Flow:
    """Goes through the lines of one program."""

    def __init__(self, lines: list[Line], variables: Variables) -> None:
        self._lines = lines
        self._variables = variables
        self._left: dict[int, int] = {}
        """how often each repeat in hand is still to come, by its index"""
        self._codes = [COMMENT.sub(" ", raw).strip().upper() for _, raw in lines]
        self._words = {
            at: _Word(found[1], found[2], found[3])
            for at, code in enumerate(self._codes)
            if (found := _O_WORD.match(code))
        }

    def lines(self) -> Iterator[Line | UnreadLineError]:
        """Those that remain, in the order in which they are carried out. What cannot be steered
        comes as an error in its line, and it goes on behind it. Behind a line that could not be
        read nothing is carried out again: a loop may have no end then.

        Raises:
            TooMuchError: a loop without an end.
        """
        at = 0
        furthest = -1
        again = 0
        while at < len(self._lines):
            number, raw = self._lines[at]
            again += at <= furthest
            furthest = max(at, furthest)
            if again > MOST_LINES:
                raise TooMuchError(
                    number,
                    f"more than {MOST_LINES:,} lines are carried out again; expected loops and "
                    "jumps that end",
                )
            try:
                follows = self._follows(at)
            except InputError as error:
                yield UnreadLineError(number, str(error))
                at += 1
                continue
            if isinstance(follows, int):
                at = at + 1 if follows <= at and self._variables.lost else follows
                continue
            yield number, raw if follows is None else follows
            at += 1
            if _PROGRAM_END.search(self._codes[at - 1]):
                # what stands behind the end is said, and not carried out
                yield from self._lines[at:]
                return

    def _follows(self, at: int) -> int | str | None:
        """The index that comes next, or the line in the place of this one; None: as it stands."""
        code = self._codes[at]
        if at in self._words:
            return self._o_word(at, self._words[at])
        if found := _WHILE.match(code):
            end = self._matching(at, _END, found[2], 1)
            return at + 1 if self._holds(found[1]) else end + 1
        if found := _END.match(code):
            return self._matching(at, _WHILE, found[1], -1)
        if found := _THEN.match(code):
            return found[2] if self._holds(found[1]) else at + 1
        if found := _GOTO.match(code):
            if found[1] and not self._holds(found[1]):
                return at + 1
            return self._numbered(at, self._variables.value(found[2]))
        return None

    def _holds(self, condition: str) -> bool:
        return self._variables.value(condition) != 0

    def _matching(self, at: int, pattern: re.Pattern[str], number: str, step: int) -> int:
        """The nearest line of WHILE or END with this number, the last group of its pattern; step 1:
        ahead, -1: back.

        Raises:
            InputError: there is none.
        """
        at += step
        while 0 <= at < len(self._codes):
            found = pattern.match(self._codes[at])
            if found and found.groups()[-1] == number:
                return at
            at += step
        raise InputError(f"the loop {number} has no other end; expected WHILE and END")

    def _numbered(self, at: int, number: float) -> int:
        """The block N of this number: ahead first, then from the beginning.

        Raises:
            InputError: there is none.
        """
        known = self._numbers.get(round(number), ()) if number == round(number) else ()
        own = bisect_right(self._programs, at)
        found = [index for index in known if bisect_right(self._programs, index) == own]
        if not found:
            raise InputError(f"GOTO {number:g}, and no block N{number:g} is in the program")
        return next((index for index in found if index > at), found[0])

    @cached_property
    def _programs(self) -> list[int]:
        """The indices where a program of a number begins: a jump stays in its own."""
        return [at for at, code in enumerate(self._codes) if _PROGRAM.match(code)]

    @cached_property
    def _numbers(self) -> dict[int, list[int]]:
        """The indices of the blocks by their N, rising."""
        found: dict[int, list[int]] = {}
        for at, code in enumerate(self._codes):
            if block := _BLOCK.match(code):
                found.setdefault(int(block[1]), []).append(at)
        return found

    def _o_word(self, at: int, word: _Word) -> int:
        """Where an o-word leads."""
        loops = ("ENDWHILE", "ENDREPEAT", "WHILE")
        match word.kind:
            case "WHILE":
                return self._while(at, word)
            case "REPEAT":
                return self._repeat(at, word)
            case "IF":
                return self._branch(at, word)
            case "ELSEIF" | "ELSE":
                # a branch that was carried out ends here
                return self._end(at, word, "ENDIF") + 1
            case "ENDWHILE":
                return self._begin(at, word, "WHILE")
            case "ENDREPEAT":
                return self._again(at, word)
            case "BREAK":
                return self._end(at, word, *loops) + 1
            case "CONTINUE":
                return self._end(at, word, *loops)
            case _:
                return at + 1

    def _while(self, at: int, word: _Word) -> int:
        """At the head of a loop, or at the foot of one that begins with DO."""
        holds = self._holds(word.rest)
        foot = self._find(at, word, -1, "DO", "ENDWHILE", "WHILE")
        if foot is not None and self._words[foot].kind == "DO":
            return foot + 1 if holds else at + 1
        end = self._end(at, word, "ENDWHILE")
        return at + 1 if holds else end + 1

    def _repeat(self, at: int, word: _Word) -> int:
        times = self._variables.value(word.rest)
        if times != int(times) or times > MOST_LINES:
            raise InputError(f"repeat [{times:g}], expected a whole number")
        self._left[at] = int(times)
        end = self._end(at, word, "ENDREPEAT")
        return at + 1 if times > 0 else end + 1

    def _again(self, at: int, word: _Word) -> int:
        begin = self._begin(at, word, "REPEAT")
        self._left[begin] = self._left.get(begin, 1) - 1
        return begin + 1 if self._left[begin] > 0 else at + 1

    def _branch(self, at: int, word: _Word) -> int:
        """Behind the first IF or ELSEIF that holds, or behind ELSE."""
        self._end(at, word, "ENDIF")
        while word.kind in {"IF", "ELSEIF"} and not self._holds(word.rest):
            at = self._end(at, word, "ELSEIF", "ELSE", "ENDIF")
            word = self._words[at]
        return at + 1

    def _end(self, at: int, word: _Word, *kinds: str) -> int:
        found = self._find(at, word, 1, *kinds)
        if found is None:
            raise InputError(f"o{word.label} {word.kind} without {' or '.join(kinds)}")
        return found

    def _begin(self, at: int, word: _Word, kind: str) -> int:
        found = self._find(at, word, -1, kind)
        if found is None:
            raise InputError(f"o{word.label} {word.kind} without {kind}")
        return found

    def _find(self, at: int, word: _Word, step: int, *kinds: str) -> int | None:
        """The nearest o-word of this label and one of these kinds; step 1: ahead, -1: back."""
        at += step
        while 0 <= at < len(self._codes):
            other = self._words.get(at)
            if other and other.label == word.label and other.kind in kinds:
                return at
            at += step
        return None
