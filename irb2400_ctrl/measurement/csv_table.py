"""CSV in the dialects that loggers write: comma, semicolon or tab, decimal comma, byte order mark,
comment lines before the header, gzip."""

from __future__ import annotations

import re
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.table import Table
from irb2400_ctrl.reading import text_blocks

COMMENTS = ("#", "%", "//")
MOST_CELLS = 19_500_000
"""of one log: 1,500,000 rows of time, six angles and six torques, 100 minutes at 250 Hz; what is
computed from as much fits into 1 GB"""
SLOW_ROWS = 10_000
"""between two reports of progress where cells are read one by one"""
MOST_TITLES = 20
"""lines of one cell that may stand above the header"""
_SEPARATOR = re.compile(r"[,;\t]")
_DECIMAL_COMMA = re.compile(r"(^|[;\t])\s*-?\d+,\d+")


@dataclass(frozen=True)
class Dialect:
    """How a file separates its cells and writes its decimals; `skip` lines stand before the
    header."""

    separator: str
    decimal: str
    skip: int


def read_csv_table(path: Path, progress: Callable[[int], None] = lambda rows: None) -> Table:
    """Columns of a `.csv`, `.csv.gz`, `.txt` or `.tsv`, read piece by piece.

    Args:
        progress: called now and then with the number of samples read so far.

    Raises:
        InputError: not readable as text, no header, rows of another width, too many rows.
    """
    if not path.is_file():
        raise InputError(
            f"no log file {path}: expected a .csv or .csv.gz with time_s, q1_deg…, tau1_Nm…"
        )
    head = next(text_blocks(path), b"").decode().split("\n")
    dialect = _dialect(path, head)
    header = [
        name.strip().strip('"').strip() for name in head[dialect.skip].split(dialect.separator)
    ]
    while header and not header[-1]:
        header.pop()  # a separator at the end of every line
    if len(header) < 2:
        raise InputError(
            f"{path}: the first line is {head[dialect.skip][:60]!r}, expected comma-separated "
            "names such as time_s,q1_deg"
        )
    doubled = sorted({name for name in header if header.count(name) > 1 and name})
    if doubled:
        raise InputError(
            f"{path}: column {doubled[0]!r} appears {header.count(doubled[0])} times, expected once"
        )
    columns = _fast(path, header, dialect, progress)
    if columns is None:
        columns = _slow(path, header, dialect, progress)
    if not len(columns[header[0]]):
        raise InputError(f"{path}: a header but no samples")
    return Table(path, columns, dialect.skip + 2)


def _within(path: Path, rows: int, columns: int) -> None:
    most = MOST_CELLS // columns
    if rows > most:
        raise InputError(
            f"{path}: more than {most:,} rows of {columns} columns, expected at most so many; cut "
            "the log into parts, leave columns out, or record at 250 Hz, which is enough"
        )


def _dialect(path: Path, lines: list[str]) -> Dialect:
    skip = 0
    while skip < len(lines) and (
        not lines[skip].strip() or lines[skip].lstrip().startswith(COMMENTS)
    ):
        skip += 1
    # a title above the header has one cell; a file without any second cell is refused later
    title = skip
    while title < min(len(lines), skip + MOST_TITLES) and not _SEPARATOR.search(lines[title]):
        title += 1
    if title < min(len(lines), skip + MOST_TITLES):
        skip = title
    if skip == len(lines):
        raise InputError(f"{path}: found no header, expected names such as time_s,q1_deg")
    head = lines[skip]
    separator = max((",", ";", "\t"), key=head.count)
    first = next((line for line in lines[skip + 1 :] if line.strip()), "")
    comma = separator != "," and _DECIMAL_COMMA.search(first) is not None
    return Dialect(separator, "," if comma else ".", skip)


def _fast(
    path: Path, header: list[str], dialect: Dialect, progress: Callable[[int], None]
) -> dict[str, Array] | None:
    """All columns by pyarrow; None where some cell needs a closer look."""
    import pyarrow as pa
    from pyarrow import csv

    columns = [np.empty(0) for _ in header]
    rows = 0
    options = {
        "read_options": csv.ReadOptions(column_names=header, use_threads=False),
        # a quote may hide the end of a row
        "parse_options": csv.ParseOptions(delimiter=dialect.separator, quote_char=False),
        "convert_options": csv.ConvertOptions(
            column_types={name: pa.float64() for name in header},
            decimal_point=dialect.decimal,
            null_values=[],
        ),
    }
    for block in _body(path, dialect):
        try:
            table = csv.read_csv(pa.py_buffer(block), **options)
        except (pa.ArrowInvalid, pa.ArrowKeyError):
            return None
        before = rows
        rows += len(table)
        _within(path, rows, len(header))
        for column, numbers in zip(columns, table.columns, strict=True):
            if len(column) < rows:
                # in place: a long log stands in memory once
                column.resize(rows + rows // 8, refcheck=False)
            column[before:rows] = numbers.to_numpy()
        progress(rows)
    for column in columns:
        column.resize(rows, refcheck=False)
    return dict(zip(header, columns, strict=True))


def _body(path: Path, dialect: Dialect) -> Iterator[bytes]:
    """The blocks of a file from the line after the header."""
    blocks = text_blocks(path)
    first = next(blocks)
    yield b"\n".join(first.split(b"\n", dialect.skip + 1)[dialect.skip + 1 :])
    yield from blocks


def _slow(
    path: Path, header: list[str], dialect: Dialect, progress: Callable[[int], None]
) -> dict[str, Array]:
    """Cell by cell, to say where a line is not like the others; a word is NaN."""
    width = len(header)
    columns = [array("d") for _ in header]
    lines = (line for block in _body(path, dialect) for line in block.decode().split("\n")[:-1])
    for number, line in enumerate(lines, dialect.skip + 2):
        if not line.strip(" ,;\t"):
            continue
        cells = line.split(dialect.separator)
        while len(cells) > width and not cells[-1].strip():
            cells.pop()
        if len(cells) != width:
            commas = len(cells) == 2 * width and dialect.separator == ","
            hint = "; with decimal commas the cells need semicolons between them" * commas
            raise InputError(
                f"{path}, line {number}: found {len(cells)} cells, expected {width} as in the "
                f"header{hint}"
            )
        for column, cell in zip(columns, cells, strict=True):
            column.append(_number(cell, dialect.decimal))
        if number % SLOW_ROWS == 0:
            _within(path, len(columns[0]), width)
            progress(len(columns[0]))
    _within(path, len(columns[0]), width)
    return {name: np.array(values) for name, values in zip(header, columns, strict=True)}


def _number(cell: str, decimal: str) -> float:
    try:
        return float(cell.strip().strip('"').replace(decimal, "."))
    except ValueError:
        return np.nan
