"""Lists in a sentence, and what a misspelt word may stand for."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence


def joined(names: Sequence[str], last: str = "and") -> str:
    """`a`, `a and b`, `a, b and c`."""
    *first, end = names
    return f"{', '.join(first)} {last} {end}" if first else end


def listed(numbers: Iterable[int]) -> str:
    """`1, 3, 4`."""
    return ", ".join(map(str, numbers))


def numbered(what: str, places: Sequence[int]) -> str:
    """`joint 4`, `joints 1, 3 and 4`."""
    return f"{what}{'s' if len(places) > 1 else ''} {joined([str(place) for place in places])}"


def up_to(what: str, number: int) -> str:
    """`joint 1`, `joints 1 to 6`."""
    return f"{what} 1" if number == 1 else f"{what}s 1 to {number}"


def counted(number: int, what: str) -> str:
    """`1 joint`, `6 joints`."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def did_you_mean(word: object, known: Iterable[str]) -> str:
    """`; did you mean gear_ripple?` where a known word is near; empty otherwise, or where it is
    that word in a wrong place."""
    near = difflib.get_close_matches(str(word), [one for one in known if one != word], n=1)
    return f"; did you mean {near[0]}?" if near else ""
