"""A header of two lines, as spreadsheets with merged cells write it: what a group of columns holds,
and below it their names."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from irb2400_ctrl.measurement.columns.signal_names import is_unit
from irb2400_ctrl.measurement.text.clock_times import seconds_of_day

LEAST = 3
"""names of a line that is a header"""
_LIST = re.compile(r"\w*[\[({].*[,;\s].*[\])}]")
"""of numbers or words in one cell"""
_IN_BRACKETS = re.compile(r"(?P<words>.*\S)\s*[\[(](?P<unit>[^\])]*)[\])]")


def grouped_names(
    above: Sequence[str], below: Sequence[str], number: Callable[[str], bool]
) -> list[str] | None:
    """`Position A1`, `Position A2`, …, `Torque A1`, …; None where these lines are no such header.

    Args:
        above: cells of the first line, empty where the group before goes on.
        below: cells of the second line, empty where the first says all.
        number: whether a cell is a number.
    """
    width = len(below)
    if width < max(LEAST, len(above)) or any(number(cell) or _is_value(cell) for cell in below):
        return None
    above = [*above, *[""] * (width - len(above))]
    if len(set(filter(None, above))) == width:
        return None
    names = []
    group = ""
    for over, name in zip(above, below, strict=True):
        group = over or group
        names.append(_joined(group, name) if over or name else "")
    # words of a first sample leave what is called the same as it was
    return names if all(names) and len(set(names)) == width else None


def _is_value(cell: str) -> bool:
    """Whether a cell that is no number is a sample's all the same: a time of day, a list."""
    return seconds_of_day(cell) is not None or _LIST.fullmatch(cell.strip()) is not None


def _joined(group: str, name: str) -> str:
    """Both as one name, a unit in brackets at its end."""
    if is_unit(name):
        told = _IN_BRACKETS.fullmatch(group)
        words = told["words"] if told and is_unit(told["unit"]) else group
        return f"{words} [{name.strip('[]() ')}]".strip()
    told = _IN_BRACKETS.fullmatch(group)
    if told and name and is_unit(told["unit"]) and _IN_BRACKETS.fullmatch(name) is None:
        return f"{told['words']} {name} [{told['unit']}]"
    return f"{group} {name}".strip()
