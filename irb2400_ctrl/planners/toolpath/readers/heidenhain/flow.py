"""The blocks in the order in which a TNC carries them out: labels, calls, repeats, jumps on a
condition."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.heidenhain.parameters import COMPARISONS, Parameters
from irb2400_ctrl.planners.toolpath.readers.heidenhain.statements import Statement
from irb2400_ctrl.planners.toolpath.readers.unread_line import TooMuchError, UnreadLineError

_LABEL = re.compile(r'^LBL\s+("[^"]+"|\d+)')
_CALL = re.compile(r'^CALL\s+LBL\s+("[^"]+"|\d+)\s*(?:REP\s*\+?(\S*))?(.*)$')
_JUMP = re.compile(
    r'^FN\s*(9|1[012])\s*:\s*IF\s+(.+?)\s+(?:EQU|NE|GT|LT)\s+(.+?)\s+GOTO\s+LBL\s+("[^"]+"|\d+)'
)
_END = re.compile(r"^END\s+PGM\b|^(?!BEGIN)[^\"]*(?<![A-Z])M0*(?:2|30)(?!\d)")
_SETS = re.compile(r"(?:FN\s*\d+\s*:\s*)?(Q\d+)\s*=")
MOST_BLOCKS = 500_000
"""that calls, repeats and jumps carry out again"""
DEEPEST = 20


class Flow:
    """Goes through the blocks of a file."""

    def __init__(self, listed: list[Statement]) -> None:
        self._listed = listed
        self._parameters = Parameters()
        self._labels = {
            found[1]: at for at, block in enumerate(listed) if (found := _LABEL.match(block.code))
        }
        self._of_cycle: set[str] = set()
        """the parameters of the cycle that is defined"""
        self._at = 0
        self._returns: list[int] = []
        """where the calls in hand go back to"""
        self._left: dict[int, int] = {}
        """how often each repeat in hand is still to come, by its index"""

    def blocks(self) -> Iterator[Statement | UnreadLineError]:
        """As they are carried out, numbers in the place of parameters; one that cannot be read
        comes as its error, and the last where blocks call each other without an end."""
        furthest = -1
        again = 0
        while self._at < len(self._listed):
            block = self._listed[self._at]
            again += self._at <= furthest
            furthest = max(self._at, furthest)
            if again > MOST_BLOCKS or len(self._returns) > DEEPEST:
                yield TooMuchError(
                    block.line,
                    f"calls of labels more than {DEEPEST} deep, or more than {MOST_BLOCKS:,} "
                    "blocks carried out again; expected calls and jumps that end",
                )
                return
            self._at += 1
            try:
                steered = self._label(block) or self._call(block) or self._jump(block)
                if not steered and block.heading is not None:
                    yield block
                elif not steered and not self._assigned(block.code):
                    yield replace(block, code=self._parameters.resolve(block.code))
            except InputError as error:
                yield UnreadLineError(block.line, str(error))
            if _END.search(block.code) and block.heading is None:
                return

    def _assigned(self, code: str) -> bool:
        """Whether a block sets a parameter, and sets it.

        Raises:
            InputError: one of the cycle that is defined: the control would drill otherwise then.
        """
        if code.startswith("CYCL DEF"):
            self._of_cycle = set(re.findall(r"\bQ\d+(?=\s*=)", code))
        found = _SETS.match(code)
        if found and found[1] in self._of_cycle:
            raise InputError(
                f"{found[1]} of the cycle before it is set anew; expected another CYCL DEF"
            )
        return self._parameters.assign(code)

    def _label(self, block: Statement) -> bool:
        found = _LABEL.match(block.code)
        if found and found[1] == "0" and self._returns:
            self._at = self._returns.pop()
        return found is not None

    def _call(self, block: Statement) -> bool:
        """A sub-program up to LBL 0, or the blocks from a label to here some times more."""
        found = _CALL.match(block.code)
        if found is None:
            return False
        target = self._target(found[1])
        call = self._at - 1
        times = re.fullmatch(r"(\d*)(?:/\d+)?", found[2] or "")
        if times is None or found[3].strip():
            raise InputError(
                f"found {block.code[:30]!r}, expected CALL LBL 1, or CALL LBL 1 REP 2 "
                "with a whole number"
            )
        if not times[1]:
            self._returns.append(self._at)
            self._at = target
            return True
        remaining = self._left.pop(call, int(times[1]))
        if remaining > 0:
            self._left[call] = remaining - 1
            self._at = target
        return True

    def _jump(self, block: Statement) -> bool:
        """FN 9 to FN 12."""
        found = _JUMP.match(block.code)
        if found is None:
            return False
        first, second = (self._parameters.expression(found[i]) for i in (2, 3))
        if COMPARISONS[int(found[1])](first, second):
            self._at = self._target(found[4])
        return True

    def _target(self, label: str) -> int:
        """Behind a label.

        Raises:
            InputError: it is not in the file.
        """
        if label not in self._labels:
            raise InputError(f"LBL {label} is not in the file; expected a label of it")
        return self._labels[label] + 1
