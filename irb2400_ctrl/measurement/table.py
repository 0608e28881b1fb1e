"""Columns of numbers by name: what any log file comes down to before its units are known."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError

_MATRIX = re.compile(r"(qd|q|tau)(_ref)?_(\w+)")
# a cell that holds a list: "[0.1, 0.2]", (0.1, 0.2), array('d', [0.1, 0.2])
_LIST = re.compile(
    r"(?:array\(\s*(?:'\w',\s*)?)?[\[(](?P<inside>[^\[\]()'\"]*)[\])](?:\s*(?:,\s*dtype=\w+)?\))?"
)
_BETWEEN = re.compile(r"[\s,;]+")


@dataclass(frozen=True)
class Table:
    """Columns of one file, each (m,); a cell that is no number is NaN.

    Args:
        first_line: number of the line in the file that holds the first sample, where it has lines.
        words: first cells of the columns that hold words.
        rows: of the file that the samples stand in, counted from 0; default every one.
    """

    path: Path
    columns: dict[str, Array]
    first_line: int | None = None
    words: Mapping[str, str] = field(default_factory=dict)
    rows: npt.NDArray[np.intp] | None = None

    def place(self, row: int) -> str:
        """Where a sample stands in the file."""
        row = row if self.rows is None else int(self.rows[row])
        return f"sample {row + 1}" if self.first_line is None else f"line {row + self.first_line}"

    @property
    def some(self) -> str:
        """The first names, for messages."""
        names = list(self.columns)
        more = f", … ({len(names)} columns)" if len(names) > 8 else ""
        return ", ".join(names[:8]) + more


def one_length(path: Path, columns: dict[str, Array]) -> Table:
    """A table of columns that a file holds one by one.

    Raises:
        InputError: no columns, or columns of different lengths.
    """
    lengths = {name: len(values) for name, values in columns.items()}
    if not lengths:
        raise InputError(f"{path}: found no columns of numbers, expected time, angles and torques")
    if len(set(lengths.values())) > 1:
        short = min(lengths, key=lengths.__getitem__)
        long = max(lengths, key=lengths.__getitem__)
        raise InputError(
            f"{path}: column {short!r} has {lengths[short]} samples, {long!r} has {lengths[long]}; "
            "expected one time base for all: name those that belong together in a column map "
            "(--columns, docs/logs.md), or resample them in the tool that wrote the file"
        )
    return Table(path, columns)


def numbered(name: str, j: int) -> str:
    """The name of column j, counted from 0, of a matrix or list: `q1_deg` of `q_deg`, `name[1]`."""
    match = _MATRIX.fullmatch(name)
    if match is None:
        return f"{name}[{j + 1}]"
    return f"{match[1]}{j + 1}{match[2] or ''}_{match[3]}"


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
