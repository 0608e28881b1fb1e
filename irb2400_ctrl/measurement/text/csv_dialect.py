"""How a text log separates its cells and writes its decimals, and where its header is."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from irb2400_ctrl.errors import InputError

COMMENTS = ("#", "%", "//")
MOST_TITLES = 20
"""lines that may stand above the header: of one cell, or of fewer than the samples have"""
FEWEST_NAMES = 3
"""of a header: a time, an angle and a torque"""
LOOKED_AT = 1000
"""lines with quotes, each of which is taken apart"""
EMPTY = " ,;\t\0"
"""what an empty line holds; zeros are what a file ends with whose recorder lost its power"""
_SEPARATOR = re.compile(r"[,;\t|]")
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")
_WIDE = re.compile(r"\s{2,}")


@dataclass(frozen=True)
class Dialect:
    """How a file separates its cells and writes its decimals; `skip` lines stand before the
    header."""

    separator: str
    decimal: str
    skip: int

    def cells(self, line: str) -> list[str]:
        """Of one line, without quotes and blanks around them."""
        return list(map(bare, self.split(line)))

    def names(self, line: str, row: str) -> list[str]:
        """Of a header; with blanks in them above columns of one width."""
        names = self.cells(line)
        wide = _WIDE.split(line.strip())
        fits = self.separator == " " and len(wide) == len(self.cells(row)) < len(names)
        return wide if fits else names

    def split(self, line: str) -> list[str]:
        """The cells as they stand; a separator between two quotes separates nothing."""
        if self.separator == " ":
            return line.split()
        # a single quote is a torn cell, and hides nothing
        if '"' in line and line.count('"') % 2 == 0:
            return next(csv.reader([line], delimiter=self.separator, skipinitialspace=True))
        return line.split(self.separator)


def bare(cell: str) -> str:
    """A cell without quotes and blanks around it."""
    return cell.strip().strip('"').strip()


def dialect_of(path: Path, lines: list[str]) -> Dialect:
    """Of a file with these first lines.

    Raises:
        InputError: no line could be a header.
    """
    skip = 0
    while skip < len(lines) and (
        not lines[skip].strip() or lines[skip].lstrip().startswith(COMMENTS)
    ):
        skip += 1
    # a title above the header has one cell; a file without any second cell is refused later
    title = skip
    while title < min(len(lines), skip + MOST_TITLES) and _cells(lines[title]) < 2:
        title += 1
    if title < min(len(lines), skip + MOST_TITLES):
        skip = title
    if skip == len(lines):
        raise InputError(f"{path}: found no header, expected names such as time_s,q1_deg")
    dialect = _dialect_at(lines, skip)
    if not _is_header(lines, dialect):
        further = range(skip + 1, min(len(lines), skip + MOST_TITLES))
        below = (_dialect_at(lines, place) for place in further if lines[place].strip())
        dialect = next((one for one in below if _is_header(lines, one)), dialect)
        skip = dialect.skip
    cells = dialect.cells(lines[skip])
    if skip and is_number(cells[0], dialect) and lines[skip - 1].lstrip().startswith(COMMENTS):
        above = lines[skip - 1].lstrip().lstrip("#%/")
        if len(dialect.cells(above)) == len(cells):
            return replace(dialect, skip=skip - 1)
    return dialect


def _dialect_at(lines: list[str], skip: int) -> Dialect:
    """Of a file whose header is line `skip`."""
    head = lines[skip]
    separator = max((",", ";", "\t", "|"), key=head.count) if _SEPARATOR.search(head) else " "
    dialect = Dialect(separator, ".", skip)
    return replace(dialect, decimal=",") if _decimal_comma(lines[skip + 1 :], dialect) else dialect


def _decimal_comma(lines: list[str], dialect: Dialect) -> bool:
    """Whether commas in the numbers of these lines are decimal ones: an arm at rest writes zeros
    first, `1,234` beside `0.5` is a thousand. Between commas numbers have them in quotes alone."""
    mark = ","
    if dialect.separator == ",":
        mark = '"'
        lines = lines[:LOOKED_AT]
    cells = (cell for line in lines if mark in line for cell in dialect.cells(line))
    numbers = filter(_DECIMAL_COMMA.fullmatch, cells)
    first = next(numbers, None)
    if first is None:
        return False
    if not all(_THOUSANDS.fullmatch(cell) for cell in chain([first], numbers)):
        return True
    points = (cell for line in lines for cell in dialect.cells(line) if "." in cell)
    return not any(is_number(cell, dialect) for cell in points)


def _is_header(lines: list[str], dialect: Dialect) -> bool:
    """Whether this line holds three names or more, and the next two lines as many cells."""
    below = [line for line in lines[dialect.skip + 1 :][:MOST_TITLES] if line.strip(EMPTY)][:2]
    names = dialect.names(lines[dialect.skip], below[0] if below else "")
    called = sum(map(bool, names))
    # spreadsheets pad a title to the width of the samples; groups stand beside a time or nothing
    title = called < FEWEST_NAMES - (not names[0])
    return (
        len(names) >= FEWEST_NAMES
        and not title
        and not any(is_number(name, dialect) for name in names)
        and bool(below)
        and all(len(dialect.cells(line)) == len(names) for line in below)
    )


def _cells(line: str) -> int:
    """How many cells of a line hold something."""
    return sum(1 for cell in _SEPARATOR.split(line) if cell.strip())


def is_number(cell: str, dialect: Dialect) -> bool:
    """Whether a cell is a number in this dialect."""
    try:
        float(cell.replace(dialect.decimal, "."))
    except ValueError:
        return False
    return True
