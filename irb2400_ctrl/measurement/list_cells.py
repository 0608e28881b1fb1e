"""Cells that hold a list of numbers: "[0.1, 0.2]", (0.1, 0.2), array('d', [0.1, 0.2])."""

from __future__ import annotations

import re

import numpy as np

from irb2400_ctrl.measurement.table import numbered

_LIST = re.compile(
    r"(?:array\(\s*(?:'\w',\s*)?)?[\[(](?P<inside>[^\[\]()'\"]*)[\])](?:\s*(?:,\s*dtype=\w+)?\))?"
)
_BETWEEN = re.compile(r"[\s,;]+")


def numbers_of(cell: str) -> list[float] | None:
    """The numbers of a list; None where the cell is none, or holds words. A word among numbers is
    NaN."""
    found = _LIST.fullmatch(cell.strip().strip('"').strip())
    if found is None:
        return None
    return [_number(word) for word in _BETWEEN.split(found["inside"].strip()) if word]


def spread(header: list[str], row: list[str]) -> tuple[list[str], dict[int, int]]:
    """The names of columns with one for every place of a list, and how long the lists are by the
    number of their column.

    Args:
        header: one name a cell.
        row: the cells of the first sample; an empty list there is a column without numbers.
    """
    names: list[str] = []
    widths: dict[int, int] = {}
    for k, name in enumerate(header):
        listed = numbers_of(row[k]) if k < len(row) else None
        if listed is None:
            names.append(name)
        else:
            widths[k] = len(listed)
            names += [numbered(name, j) for j in range(len(listed))]
    return names, widths


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return np.nan
