"""Columns of numbers by name: what any log file comes down to before its units are known."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
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
_OF_SEVERAL = re.compile(r"(?P<name>.*) \((?P<place>\d+) of (?P<n>\d+)\)")
_WHICH_JOINT = re.compile(r"(joint|axis)([ _]?(name|id|index|number|no))?", re.IGNORECASE)
_WHICH_SIGNAL = re.compile(r"(topic|signal|channel|variable|series|tag)([ _]?name)?", re.IGNORECASE)
_OF_NUMPY = re.compile(r"np\.float\d+\(([^()]*)\)")
"""a number as NumPy 2 writes it in a list: `[np.float64(0.1), np.float64(0.2)]`"""
_BETWEEN = re.compile(r"[\s,;]+")


@dataclass(frozen=True)
class Table:
    """Columns of one file, each (m,); a cell that is no number is NaN.

    Args:
        first_line: number of the line in the file that holds the first sample, where it has lines.
        words: first cells of the columns that hold words.
        rows: of the file that the samples stand in, counted from 0; default every one.
        headless: what to say where nothing names the columns (`column 1`…).
    """

    path: Path
    columns: dict[str, Array]
    first_line: int | None = None
    words: Mapping[str, str] = field(default_factory=dict)
    rows: npt.NDArray[np.intp] | None = None
    headless: str = ""

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


def distinct(header: Sequence[str]) -> list[str]:
    """The names; one that stands there k times is `name (1 of k)`, `name (2 of k)`…"""
    seen: dict[str, int] = {}
    names = []
    for name in header:
        k = seen[name] = seen.get(name, 0) + 1
        several = bool(name) and header.count(name) > 1
        names.append(f"{name} ({k} of {header.count(name)})" if several else name)
    return names


def without_copies(columns: dict[str, Array]) -> dict[str, Array]:
    """Columns of one name that hold the same numbers as one of that name."""
    found = dict(columns)
    for first in columns:
        match = _OF_SEVERAL.fullmatch(first)
        if match is None or match["place"] != "1":
            continue
        all_of = [f"{match['name']} ({k + 1} of {match['n']})" for k in range(int(match["n"]))]
        if all(np.array_equal(columns[first], columns[n], equal_nan=True) for n in all_of[1:]):
            found[match["name"]] = columns[first]
            for name in all_of:
                del found[name]
    return found


def source_of(name: str, names: Sequence[str]) -> str:
    """Which of a file's columns is called so: the first where several are."""
    copies = (match for other in names if (match := _OF_SEVERAL.fullmatch(other)))
    return next((copy[0] for copy in copies if copy["name"] == name), name)


def said_of_copies(names: Iterable[str]) -> str:
    """For a message: a name that several columns have; empty where each has its own."""
    found = next((match for name in names if (match := _OF_SEVERAL.fullmatch(name))), None)
    if found is None:
        return ""
    return f"; column {found['name']!r} appears {found['n']} times, expected once"


def said_of_joint_rows(names: Iterable[str]) -> str:
    """For a message: a column that says which joint or signal a row is of; empty where none
    does."""
    names = list(names)
    signal = next((name for name in names if _WHICH_SIGNAL.fullmatch(name)), None)
    if signal is not None and "value" in map(str.lower, names):
        return (
            f"; column {signal!r} looks like the signal that a row is of: expected a row per "
            "sample with a column for every signal (pandas: table.pivot(index=time, "
            f"columns={signal!r}, values='value'))"
        )
    found = next((name for name in names if _WHICH_JOINT.fullmatch(name)), None)
    if found is None:
        return ""
    return (
        f"; column {found!r} looks like the joint that a row is of: expected a row per sample with "
        "a column for every joint, or the columns time_s, joint, position, velocity, effort "
        "(rad, Nm) with the joints' names"
    )


def numbered(name: str, j: int) -> str:
    """The name of column j, counted from 0, of a matrix or list: `q1_deg` of `q_deg`, `name[1]`."""
    match = _MATRIX.fullmatch(name)
    if match is None:
        return f"{name}[{j + 1}]"
    return f"{match[1]}{j + 1}{match[2] or ''}_{match[3]}"


def numbers_of(cell: str) -> list[float] | None:
    """The numbers of a list; None where the cell is none, or holds words. A word among numbers is
    NaN."""
    found = _LIST.fullmatch(_OF_NUMPY.sub(r"\1", cell.strip().strip('"').strip()))
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
