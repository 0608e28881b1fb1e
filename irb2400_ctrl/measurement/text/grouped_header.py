"""A header of two lines, as spreadsheets with merged cells write it: what a group of columns holds,
and below it their names."""

from __future__ import annotations

from collections.abc import Callable, Sequence

LEAST = 3
"""names of a line that is a header"""


def grouped_names(
    above: Sequence[str], below: Sequence[str], number: Callable[[str], bool]
) -> list[str] | None:
    """`Position A1`, `Position A2`, …, `Torque A1`, …; None where these lines are no such header.

    Args:
        above: cells of the first line, empty where the group before goes on.
        below: cells of the second line.
        number: whether a cell is a number.
    """
    if len(below) < max(LEAST, len(above)) or not all(below) or any(map(number, below)):
        return None
    told = [cell for cell in above if cell]
    if len(set(told)) == len(below) or len(set(below)) == len(below):
        return None
    names = []
    group = ""
    for k, name in enumerate(below):
        group = (above[k] if k < len(above) else "") or group
        names.append(f"{group} {name}".strip())
    return names
