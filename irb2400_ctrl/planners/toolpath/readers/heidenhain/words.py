"""The words of a block that moves: coordinates, feeds, M functions."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.heidenhain.statements import NUMBER

_WORD = re.compile(
    r"\s*(?:(?P<alone>F\s*MAX|F\s*AUTO|R0(?![\d.])|RL|RR|DR[+-](?![\d.])|MB\s*MAX)"
    rf"|(?P<letter>I?[XYZABCUVW]|I?P[AR]|[NT][XYZ]|F[UZT]?|MB|LA|R|M)\s*(?P<number>{NUMBER}"
    r"|[-+]?\s*Q12[012]))"
)
# the F and the LA behind these functions are theirs
_OWNERS = frozenset([103, 120, 128, 140])
# how far the handwheel may move the axes behind M118
_HANDWHEEL = frozenset("XYZABC")
# M94 shows the angles of these axes within a turn, and turns none
_SHOWN = re.compile(r"(?:\s+[ABC](?![\w+-]))+")
# the tool's axis in the words of the G-code reader: as stated, or the normal of the surface
VECTOR = dict(zip(("TX", "TY", "TZ"), ("A3", "B3", "C3"), strict=True))
NORMAL = dict(zip(("NX", "NY", "NZ"), VECTOR.values(), strict=True))
ACROSS = (
    "LN without TX, TY, TZ under tool centre control: the tool stands across the surface, along "
    "NX, NY, NZ"
)


@dataclass
class Words:
    """What a block states."""

    numbers: dict[str, float] = field(default_factory=dict)
    """by their letter; `IX` counts from where the tool is"""
    to_plane: bool = False
    """angles that the control has calculated for the tilted plane: A+Q120"""
    feed: str = ""
    """"MAX", "AUTO", or empty: one in `numbers`, or none"""
    compensated: str = ""
    """RL or RR; R0 where it ends"""
    turning: float = 0.0
    """DR+ or DR-"""
    functions: list[int] = field(default_factory=list)
    """M"""
    retreat: float | None = None
    """of M140: how far, inf for as far as the machine can [mm]"""

    def tool_axis(self, order: str, *, tool_centre: bool) -> tuple[dict[str, float], str]:
        """What leads the tool's axis, in the words of the G-code reader, and what is to be said of
        it. An LN without TX, TY, TZ keeps the tool across the surface under tool centre control
        (Heidenhain, TNC 640 User's Manual, "Face milling")."""
        stated = VECTOR.keys() & self.numbers.keys()
        across = order == "LN" and tool_centre and not stated
        found = NORMAL if across else VECTOR
        values = {name: self.numbers[key] for key, name in found.items() if key in self.numbers}
        return values, ACROSS if across and values else ""


def words_of(code: str) -> Words:
    """The words behind the order of a block, or of a block of M functions.

    Raises:
        InputError: what is no word, a word twice.
    """
    found = Words()
    at = 0
    while code[at:].strip():
        word = _WORD.match(code, at)
        if word is None:
            raise InputError(
                f"found {code[at:].strip()[:30]!r}, expected words such as X+10, R0, FMAX, M3"
            )
        at = word.end()
        if word["alone"]:
            _alone(found, "".join(word["alone"].split()))
            continue
        letter = word["letter"]
        number = word["number"].replace(" ", "")
        if "Q" in number:
            found.to_plane = True
            continue
        value = float(number)
        if letter == "M":
            found.functions.append(int(value))
            shown = _SHOWN.match(code, at) if value == 94 else None
            at = at if shown is None else shown.end()
        elif letter == "MB":
            found.retreat = value
        elif _owned(letter, found.functions):
            continue
        elif letter in found.numbers:
            raise InputError(f"found {letter} twice in one block, expected it once")
        else:
            found.numbers[letter] = value
    return found


def _owned(letter: str, functions: list[int]) -> bool:
    """Whether a word belongs to a function before it."""
    if letter == "F":
        return bool(_OWNERS & set(functions))
    return letter == "LA" or (letter in _HANDWHEEL and 118 in functions)


def _alone(found: Words, word: str) -> None:
    if word.startswith("F"):
        found.feed = word[1:]
    elif word.startswith("DR"):
        found.turning = 1.0 if word[2] == "+" else -1.0
    elif word.startswith("MB"):
        found.retreat = float("inf")
    else:
        found.compensated = word
