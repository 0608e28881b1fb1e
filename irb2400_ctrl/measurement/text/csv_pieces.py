"""The samples of a CSV, piece by piece: by pyarrow where every cell is a plain number, else cell by
cell."""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.table import numbers_of
from irb2400_ctrl.measurement.text.clock_times import Midnights, seconds_of_day
from irb2400_ctrl.measurement.text.csv_dialect import EMPTY, Dialect, bare
from irb2400_ctrl.measurement.text.mixed_decimals import MixedDecimals
from irb2400_ctrl.reading import text_blocks

_BLANKS = re.compile(r"\s+")
SLOW_ROWS = 10_000
"""of a piece, where cells are read one by one"""
Piece = Callable[[Sequence[str]], list[Array]]
"""the numbers in columns of these names of some rows, each (rows,)"""


class CloserLook(Exception):
    """Not every cell is a number as plain as the fast reader takes them."""


@dataclass(frozen=True)
class Body:
    """The samples of a file: what stands from line `start` on, lines counted from 0; cells that
    hold times of day, by their place in a line, and those that name the joints, with the names."""

    path: Path
    dialect: Dialect
    start: int
    clocks: frozenset[int] = frozenset()
    joints: Mapping[int, str] = field(default_factory=dict)
    text: Callable[[Path], Iterator[bytes]] = text_blocks

    def blocks(self) -> Iterator[bytes]:
        """Whole lines in each, one blank between cells where blanks separate them."""
        blocks = self.text(self.path)
        first = next(blocks)
        yield self._lines(b"\n".join(first.split(b"\n", self.start)[self.start :]))
        for block in blocks:
            yield self._lines(block)

    def _lines(self, block: bytes) -> bytes:
        if self.dialect.separator != " ":
            return block
        return b"\n".join(b" ".join(line.split()) for line in block.split(b"\n"))


def fast_pieces(body: Body, header: list[str]) -> Iterator[Piece]:
    """Pieces of the file, read by pyarrow.

    Raises:
        CloserLook: some cell needs a closer look, or pyarrow is missing.
    """
    try:
        import pyarrow as pa
        from pyarrow import csv as arrow_csv
    except ImportError as error:
        raise CloserLook from error

    options = {
        "read_options": arrow_csv.ReadOptions(column_names=header, use_threads=False),
        # a quote may hide the end of a row
        "parse_options": arrow_csv.ParseOptions(delimiter=body.dialect.separator, quote_char=False),
    }

    def numbers(block: bytes, names: Sequence[str]) -> list[Array]:
        """Of some columns, (rows,) each; the cells of the others are not looked at."""
        wanted = arrow_csv.ConvertOptions(
            include_columns=names,
            column_types={name: pa.float64() for name in names},
            decimal_point=body.dialect.decimal,
            null_values=[],
        )
        try:
            table = arrow_csv.read_csv(pa.py_buffer(block), **options, convert_options=wanted)
        except (pa.ArrowInvalid, pa.ArrowKeyError) as error:
            raise CloserLook from error
        return [column.to_numpy() for column in table.columns]

    for block in body.blocks():
        yield partial(numbers, block)


class _Samples:
    """Lines of numbers until they are taken. One that was perhaps cut inside its last cell, the
    first word in a column of numbers, counts once another line follows."""

    def __init__(self, width: int) -> None:
        self._columns = [array("d") for _ in range(width)]
        self._held: list[float] = []
        self._numbers = True
        self.none = True

    @property
    def rows(self) -> int:
        return len(self._columns[0])

    def go_on(self) -> None:
        """Another line follows."""
        if not self._held:
            return
        for column, value in zip(self._columns, self._held, strict=True):
            column.append(value)
        self._held = []

    def add(self, values: list[float], last: str) -> None:
        """The numbers of a line, and its last cell."""
        first = self._numbers and np.isnan(values[-1])
        self._numbers = self._numbers and not first
        self._held = values
        if self.none or not first or _says_nan(last):
            self.go_on()
        self.none = False

    def taken(self) -> list[Array]:
        """One array a column, of the lines since the last time."""
        found = [np.array(column) for column in self._columns]
        for column in self._columns:
            del column[:]
        return found


def slow_pieces(
    body: Body, header: list[str], names: list[str], widths: dict[int, int]
) -> Iterator[Piece]:
    """Cell by cell, to say where a line is not like the others; a word is NaN. A last line that
    ends early, or in the only word of the last column, was being written when the recorder stopped:
    it is left out.

    Args:
        body: the samples.
        header: a name a cell.
        names: of the columns, those of lists one by one.
        widths: how many numbers the lists hold, by the number of their cell.
    """
    width = len(header)
    samples = _Samples(len(names))
    midnights = {header[k]: Midnights() for k in body.clocks}
    mixed = MixedDecimals() if body.dialect.decimal == "," else None
    torn: InputError | None = None

    def piece(numbers: Mapping[str, Array], names: Sequence[str]) -> list[Array]:
        return [numbers[name] for name in names]

    def so_far() -> Piece:
        numbers = dict(zip(names, samples.taken(), strict=True))
        for name, beyond in midnights.items():
            numbers[name] = beyond(numbers[name])
        return partial(piece, numbers)

    lines = (line for block in body.blocks() for line in block.decode().split("\n")[:-1])
    for number, line in enumerate(lines, body.start + 1):
        if not line.strip(EMPTY):
            continue
        if torn is not None:
            raise torn
        samples.go_on()
        cells = body.dialect.split(line)
        while len(cells) > width and not cells[-1].strip():
            cells.pop()
        if len(cells) != width:
            torn = _wrong_width(body, number, line, len(cells), width)
            if len(cells) > width or samples.none:
                raise torn
            continue
        place = f"{body.path}, line {number}"
        _same_joints(body, cells, place)
        if mixed is not None:
            mixed.look(number, ["" if k in body.clocks else bare(c) for k, c in enumerate(cells)])
        samples.add(_values(body, cells, widths, place), cells[-1])
        if samples.rows >= SLOW_ROWS:
            yield so_far()
    if mixed is not None:
        mixed.check(body.path, header)
    if samples.rows:
        yield so_far()


def _says_nan(cell: str) -> bool:
    """Whether a cell says that it holds no number, as no cell says that was cut."""
    return bare(cell).lower() in {"nan", "null", "none"}


def _same_joints(body: Body, cells: list[str], place: str) -> None:
    """Refuse a line whose joints are not those of the first sample, or in another order."""
    for k, name in body.joints.items():
        there = cells[k].strip().strip('"').strip()
        if there and _BLANKS.sub("", there) != _BLANKS.sub("", name):
            raise InputError(
                f"{place}: found joint {there[:60]!r}, expected {name[:60]!r} as in the first "
                "sample: two publishers, or two records, write into one topic; give each a file of "
                "its own"
            )


def _wrong_width(body: Body, number: int, line: str, found: int, width: int) -> InputError:
    commas = found > width and body.dialect.separator == "," and "." not in line
    hint = "; with decimal commas the cells need semicolons between them" * commas
    if body.dialect.separator == "," and re.search(r"[\[({]", line):
        hint = "; a list with commas needs quotes around it, or other separators outside"
    if line.count('"') % 2:
        hint = (
            "; a quote is not closed in its line: a list goes on in the next ones, where one line "
            "a sample is expected (of numpy, write array.tolist())"
        )
    return InputError(
        f"{body.path}, line {number}: found {found} cells, expected {width} as in the header{hint}"
    )


def _values(body: Body, cells: list[str], widths: dict[int, int], place: str) -> list[float]:
    """The numbers of a line; a cell without anything where a list is expected holds none."""
    values = []
    for k, cell in enumerate(cells):
        if k in body.clocks:
            seconds = seconds_of_day(cell)
            values.append(np.nan if seconds is None else seconds)
            continue
        if k not in widths:
            values.append(_number(cell, body.dialect.decimal))
            continue
        listed = numbers_of(cell) if cell.strip() else [np.nan] * widths[k]
        if listed is None or len(listed) != widths[k]:
            raise InputError(
                f"{place}: found {cell.strip()[:40]!r} in cell {k + 1}, expected a list of "
                f"{widths[k]} numbers as in the first sample"
            )
        values += listed
    return values


def _number(cell: str, decimal: str) -> float:
    try:
        # a list of numbers over several cells: `(0.1`, `0.2`, `0.3)`
        return float(bare(cell).strip("()[]").replace(decimal, "."))
    except ValueError:
        return np.nan
