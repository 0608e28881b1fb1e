"""CSV in the dialects that loggers write: comma, semicolon, tab or blanks, decimal comma, byte
order mark or a code page of Windows, comment lines before the header or the header itself as one, a
line of units below it, times of day, gzip."""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.clock_times import past_midnight, seconds_of_day
from irb2400_ctrl.measurement.columns.signal_names import is_unit
from irb2400_ctrl.measurement.csv_dialect import (
    COMMENTS,
    EMPTY,
    Dialect,
    dialect_of,
    is_number,
)
from irb2400_ctrl.measurement.table import (
    Table,
    distinct,
    numbers_of,
    spread,
    without_copies,
)
from irb2400_ctrl.reading import text_blocks

MOST_CELLS = 19_500_000
"""of one log: 1,500,000 rows of time, six angles and six torques, 100 minutes at 250 Hz; what is
computed from as much fits into 1 GB"""
_WIDE = re.compile(r"\s{2,}")
SLOW_ROWS = 10_000
"""between two reports of progress where cells are read one by one"""


@dataclass(frozen=True)
class Body:
    """The samples of a file: what stands from line `start` on, lines counted from 0; cells that
    hold times of day, by their place in a line."""

    path: Path
    dialect: Dialect
    start: int
    clocks: frozenset[int] = frozenset()
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


def read_csv_table(
    path: Path,
    progress: Callable[[int], None] = lambda rows: None,
    text: Callable[[Path], Iterator[bytes]] = text_blocks,
) -> Table:
    """Columns of a `.csv`, `.csv.gz`, `.txt` or `.tsv`, read piece by piece.

    Args:
        path: of the file.
        progress: called now and then with the number of samples read so far.
        text: the lines of the file, whole lines in every block; of another kind of file than text
            the lines that it holds.

    Raises:
        InputError: not readable as text, no header, rows of another width, too many rows.
    """
    if not path.is_file():
        raise InputError(
            f"no log file {path}: expected a .csv or .csv.gz with time_s, q1_deg…, tau1_Nm…"
        )
    head = next(text(path), b"").decode().split("\n")
    dialect = dialect_of(path, head)
    header = _header(path, head, dialect)
    headless = _headless(path, head, dialect, header)
    if headless:
        header = [f"column {k + 1}" for k in range(len(header))]
    start = dialect.skip + (0 if headless else 1)
    row = _first_row(path, head, dialect, start)
    if is_unit(row[0]) and not any(is_number(cell, dialect) for cell in row):
        units = [f" [{cell.strip('[]()')}]" if cell else "" for cell in row]
        units += [""] * (len(header) - len(row))
        header = [name + unit for name, unit in zip(header, units, strict=False)]
        start += 1 + next(k for k, line in enumerate(head[start:]) if line.strip(EMPTY))
        row = _first_row(path, head, dialect, start)
    header = distinct(header)
    clocks = {k for k, cell in enumerate(row) if seconds_of_day(cell) is not None}
    if len(clocks) == 1 and "time_s" not in header:
        header[min(clocks)] = "time_s"
    body = Body(path, dialect, start, frozenset(clocks), text)
    names, widths = spread(header, row)
    columns = None if widths or clocks else _fast(body, header, progress)
    if columns is None:
        columns = _slow(body, len(header), names, widths, progress)
    for k in clocks:
        columns[header[k]] = past_midnight(columns[header[k]])
    words = {
        name: cell
        for k, (name, cell) in enumerate(zip(header, row, strict=False))
        if cell and k not in clocks and not is_number(cell, dialect)
    }
    return Table(path, without_copies(columns), start + 1, words, headless=headless)


def _first_row(path: Path, lines: list[str], dialect: Dialect, start: int) -> list[str]:
    line = next((line for line in lines[start:] if line.strip(EMPTY)), None)
    if line is None:
        raise InputError(f"{path}: found a header but no samples, expected rows below it")
    return dialect.cells(line)


def _header(path: Path, lines: list[str], dialect: Dialect) -> list[str]:
    line = lines[dialect.skip].strip()
    for mark in COMMENTS:
        line = line.removeprefix(mark)
    header = dialect.cells(line)
    row = next((text for text in lines[dialect.skip + 1 :] if text.strip(EMPTY)), "")
    wide = _WIDE.split(line.strip())
    if dialect.separator == " " and len(wide) == len(dialect.cells(row)) < len(header):
        header = wide  # names with blanks in them, above columns of one width
    while header and not header[-1]:
        header.pop()  # a separator at the end of every line
    if len(header) < 2:
        topic = line.split(":")[0] in {"header", "name", "position"}
        raise InputError(
            f"{path}: the first line is {lines[dialect.skip][:60]!r}, expected comma-separated "
            "names such as time_s,q1_deg"
            + "; of a topic give the bag itself, or rostopic echo -p"
            * topic
        )
    return header


def _headless(path: Path, lines: list[str], dialect: Dialect, header: list[str]) -> str:
    """What to say of a file whose first line holds numbers; empty where it holds names."""
    if not (is_number(header[0], dialect) and is_number(header[1], dialect)):
        return ""
    return (
        f"{path}, line {dialect.skip + 1}: found numbers ({lines[dialect.skip].strip()[:40]}…), "
        f"expected a line of names such as time_s,q1_deg above them, {len(header)} in all: write "
        f"it into the file, or say in a column map (--columns, docs/logs.md) what 'column 1' to "
        f"'column {len(header)}' are (file = 'column {{j+1}}', joints = 6: from column 2 on)"
    )


def _within(path: Path, rows: int, columns: int) -> None:
    most = MOST_CELLS // columns
    if rows > most:
        raise InputError(
            f"{path}: more than {most:,} rows of {columns} columns, expected at most so many; cut "
            "the log into parts, leave columns out, or record at 250 Hz, which is enough"
        )


def _fast(
    body: Body, header: list[str], progress: Callable[[int], None]
) -> dict[str, Array] | None:
    """All columns by pyarrow; None where some cell needs a closer look, or pyarrow is missing."""
    try:
        import pyarrow as pa
        from pyarrow import csv as arrow_csv
    except ImportError:
        return None

    columns = [np.empty(0) for _ in header]
    rows = 0
    options = {
        "read_options": arrow_csv.ReadOptions(column_names=header, use_threads=False),
        # a quote may hide the end of a row
        "parse_options": arrow_csv.ParseOptions(delimiter=body.dialect.separator, quote_char=False),
        "convert_options": arrow_csv.ConvertOptions(
            column_types={name: pa.float64() for name in header},
            decimal_point=body.dialect.decimal,
            null_values=[],
        ),
    }
    for block in body.blocks():
        try:
            table = arrow_csv.read_csv(pa.py_buffer(block), **options)
        except (pa.ArrowInvalid, pa.ArrowKeyError):
            return None
        before = rows
        rows += len(table)
        _within(body.path, rows, len(header))
        for column, numbers in zip(columns, table.columns, strict=True):
            if len(column) < rows:
                # in place: a long log stands in memory once
                column.resize(rows + rows // 8, refcheck=False)
            column[before:rows] = numbers.to_numpy()
        progress(rows)
    for column in columns:
        column.resize(rows, refcheck=False)
    return dict(zip(header, columns, strict=True))


def _slow(
    body: Body,
    width: int,
    names: list[str],
    widths: dict[int, int],
    progress: Callable[[int], None],
) -> dict[str, Array]:
    """Cell by cell, to say where a line is not like the others; a word is NaN. A last line that
    ends early was being written when the recorder stopped: it is left out.

    Args:
        body: the samples.
        width: cells of a line.
        names: of the columns, those of lists one by one.
        widths: how many numbers the lists hold, by the number of their cell.
        progress: called with the number of samples read so far.
    """
    columns = [array("d") for _ in names]
    torn: InputError | None = None
    lines = (line for block in body.blocks() for line in block.decode().split("\n")[:-1])
    for number, line in enumerate(lines, body.start + 1):
        if not line.strip(EMPTY):
            continue
        if torn is not None:
            raise torn
        cells = body.dialect.split(line)
        while len(cells) > width and not cells[-1].strip():
            cells.pop()
        if len(cells) != width:
            torn = _wrong_width(body, number, line, len(cells), width)
            if len(cells) > width or not columns[0]:
                raise torn
            continue
        place = f"{body.path}, line {number}"
        for column, value in zip(columns, _values(body, cells, widths, place), strict=True):
            column.append(value)
        if number % SLOW_ROWS == 0:
            _within(body.path, len(columns[0]), len(names))
            progress(len(columns[0]))
    _within(body.path, len(columns[0]), len(names))
    return {name: np.array(values) for name, values in zip(names, columns, strict=True)}


def _wrong_width(body: Body, number: int, line: str, found: int, width: int) -> InputError:
    commas = found == 2 * width and body.dialect.separator == ","
    hint = "; with decimal commas the cells need semicolons between them" * commas
    if body.dialect.separator == "," and re.search(r"[\[({]", line):
        hint = "; a list with commas needs quotes around it, or other separators outside"
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
        return float(cell.strip().strip('"').replace(decimal, "."))
    except ValueError:
        return np.nan
