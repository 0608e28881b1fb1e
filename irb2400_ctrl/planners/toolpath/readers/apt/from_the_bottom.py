"""Holes whose points are their bottoms and whose heights count from the file's zero.

Autodesk's post processors for ISO 4343 (Fusion, HSMWorks) write `CYCLE/DRILL, depth, MMPM, feed,
clearance, RAPTO, way down` so, with the cycle's feed in a `FEDRAT/` before each point, which no
other writer puts there.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt.cycles import CYCLE_FEED_WORDS
from irb2400_ctrl.planners.toolpath.readers.apt.statements import (
    COMMENT,
    Statement,
    is_number,
    number,
)
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle
from irb2400_ctrl.planners.toolpath.readers.unread_line import UnreadLineError

FROM_THE_BOTTOM = (
    "a FEDRAT/ with the feed of the cycle before its points: they are the bottoms of the holes, "
    "and the clearance is a height over the file's zero (Autodesk's posts for ISO 4343)"
)


def from_the_bottom(program: list[Statement | UnreadLineError]) -> dict[int, Statement]:
    """The cycles so stated, by their line, with words before their numbers."""
    read = [s for s in program if isinstance(s, Statement) and s.word != COMMENT]
    return {
        cycle.line: named
        for cycle, behind in pairwise(read)
        if cycle.word == "CYCLE" and behind.word == "FEDRAT"
        and (named := _with_words(cycle, behind)) is not None
    }  # fmt: skip


def _with_words(cycle: Statement, feed: Statement) -> Statement | None:
    """KIND, depth, …, unit, feed, clearance[, way aside], …; None where it is not so stated, or not
    with this feed."""
    stated = cycle.arguments
    unit = next((i for i, word in enumerate(cycle.words) if word in CYCLE_FEED_WORDS), 0)
    behind = stated[unit + 1 : unit + 3]
    numbers = (*stated[1:2], *behind)
    if unit < 2 or len(numbers) < 3 or not all(map(is_number, numbers)):
        return None
    fed = [number(argument, feed.word) for argument in feed.arguments if is_number(argument)]
    if number(behind[0], cycle.word) not in fed:
        return None
    rest = stated[unit + 3 :]
    aside = bool(rest) and is_number(rest[0])
    named = (stated[0], "DEPTH", *stated[1 : unit + 2], "CLEAR", behind[1], *rest[aside:])
    return replace(cycle, arguments=named)


def over_the_bottom(cycle: HoleCycle, height: float, *, upright: bool) -> HoleCycle:
    """The hole of a point that is its bottom.

    Args:
        cycle: with heights over the file's zero.
        height: of the point over it [m].
        upright: whether the tool stands along the file's z.

    Raises:
        InputError: heights that do not leave the hole its depth, or an inclined tool.
    """
    if not upright:
        raise InputError(
            f"{FROM_THE_BOTTOM}; with an inclined tool that is not read: let the CAM system write "
            "the holes as moves, or G-code"
        )
    if cycle.clearance - height < cycle.depth - 1e-6:
        raise InputError(
            f"{FROM_THE_BOTTOM}; but from there ({1e3 * cycle.clearance:.6g} mm) to the point "
            f"({1e3 * height:.6g} mm) is less than the depth of {1e3 * cycle.depth:.6g} mm: "
            "expected no FEDRAT/ there where the points are on the surface"
        )
    begins = cycle.clearance - height
    return replace(cycle, depth=0.0, clearance=begins, retract=cycle.retract - height)
