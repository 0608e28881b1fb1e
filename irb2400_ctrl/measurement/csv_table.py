"""CSV in the dialects that loggers write: comma, semicolon, tab, bar or blanks, decimal comma, byte
order mark or a code page of Windows, comment lines before the header or the header itself as one, a
line of units below it, times of day, gzip."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.signal_names import TIME_WORDS, is_unit
from irb2400_ctrl.measurement.stretch import Cut, Inside, Rows
from irb2400_ctrl.measurement.table import (
    Table,
    distinct,
    source_of,
    spread,
    without_copies,
)
from irb2400_ctrl.measurement.text.clock_times import seconds_of_day
from irb2400_ctrl.measurement.text.csv_dialect import (
    COMMENTS,
    EMPTY,
    Dialect,
    dialect_of,
    is_number,
)
from irb2400_ctrl.measurement.text.csv_pieces import (
    Body,
    CloserLook,
    Piece,
    fast_pieces,
    slow_pieces,
)
from irb2400_ctrl.measurement.text.echoed_topic import echoed_names, names_joint
from irb2400_ctrl.measurement.text.grouped_header import grouped_names
from irb2400_ctrl.measurement.text.long_table import long_table
from irb2400_ctrl.measurement.text.scope_export import scope_export
from irb2400_ctrl.reading import text_blocks

MOST_CELLS = 19_500_000
"""of one log: 1,500,000 rows of time, six angles and six torques, 100 minutes at 250 Hz; what is
computed from as much fits into 1 GB"""


def read_csv_table(
    path: Path,
    progress: Callable[[int], None] = lambda rows: None,
    cut: Cut | None = None,
    text: Callable[[Path], Iterator[bytes]] = text_blocks,
) -> Table:
    """Columns of a `.csv`, `.csv.gz`, `.txt` or `.tsv`, read piece by piece.

    Args:
        path: of the file.
        progress: called now and then with the number of samples read so far.
        cut: the rows that are kept; default all.
        text: the lines of the file, whole lines in every block; of another kind of file than text
            the lines that it holds.

    Raises:
        InputError: not readable as text, no header, rows of another width, too many rows, none in
            the cut.
    """
    export = scope_export(path, text)
    if export is not None:
        text = partial(export.rows, text=text)
    long = long_table(path, text)
    if long is not None:
        text = partial(long.rows, text=text)
    head = next(text(path), b"").decode().split("\n")
    dialect = dialect_of(path, head)
    header, row, start, headless = _named(path, head, dialect)
    header = distinct(header)
    clocks = {k for k, cell in enumerate(row) if seconds_of_day(cell) is not None}
    called = {k for k in clocks if header[k].lower() in TIME_WORDS}
    times = called if len(called) == 1 else clocks
    if len(times) == 1 and "time_s" not in header:
        header[min(times)] = "time_s"
    joints = {k: row[k] for k, name in enumerate(header[: len(row)]) if names_joint(name, row[k])}
    body = Body(path, dialect, start, frozenset(clocks), joints, text)
    names, widths = spread(header, row)
    words = {
        name: cell
        for k, (name, cell) in enumerate(zip(header, row, strict=False))
        if cell and k not in clocks and not is_number(cell, dialect)
    }
    first_line = start + 1 if long is None and export is None else None
    empty = Table(path, {}, first_line, words, headless=headless)
    if not widths and not clocks:
        with contextlib.suppress(CloserLook):
            return _gathered(fast_pieces(body, header), empty, header, cut, progress)
    return _gathered(slow_pieces(body, header, names, widths), empty, names, cut, progress)


def _named(path: Path, head: list[str], dialect: Dialect) -> tuple[list[str], list[str], int, str]:
    """Names of the columns, cells of the first sample, the line that it may stand in first (from
    0), and what to say of a file without names."""
    header = _header(path, head, dialect)
    headless = _headless(path, head, dialect, header)
    start = dialect.skip + (0 if headless else 1)
    if headless:
        known = echoed_names(header, lambda cell: is_number(cell, dialect))
        headless = "" if known else headless
        header = known or [f"column {k + 1}" for k in range(len(header))]
    row = _first_row(path, head, dialect, start)
    grouped = grouped_names(header, row, lambda cell: is_number(cell, dialect))
    if grouped:
        header = grouped
        start = _behind(head, start)
        row = _first_row(path, head, dialect, start)
    if any(map(is_unit, row)) and not any(is_number(cell, dialect) for cell in row):
        units = [f" [{cell.strip('[]()')}]" if cell else "" for cell in row]
        units += [""] * (len(header) - len(row))
        header = [name + unit for name, unit in zip(header, units, strict=False)]
        start = _behind(head, start)
        row = _first_row(path, head, dialect, start)
    return header, row, start, headless


def _behind(lines: list[str], start: int) -> int:
    """The line behind the first with something in it."""
    return start + 1 + next(k for k, line in enumerate(lines[start:]) if line.strip(EMPTY))


def _first_row(path: Path, lines: list[str], dialect: Dialect, start: int) -> list[str]:
    line = next((line for line in lines[start:] if line.strip(EMPTY)), None)
    if line is None:
        raise InputError(f"{path}: found a header but no samples, expected rows below it")
    return dialect.cells(line)


def _header(path: Path, lines: list[str], dialect: Dialect) -> list[str]:
    line = lines[dialect.skip].strip()
    for mark in COMMENTS:
        line = line.removeprefix(mark)
    row = next((text for text in lines[dialect.skip + 1 :] if text.strip(EMPTY)), "")
    header = dialect.names(line, row)
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


def _gathered(
    pieces: Iterable[Piece],
    empty: Table,
    names: list[str],
    cut: Cut | None,
    progress: Callable[[int], None],
) -> Table:
    """All pieces of a file as one table; of a cut the rows inside alone."""
    columns = [np.empty(0) for _ in names]
    inside: Inside | None = None
    kept_rows: list[Rows] = []
    read = kept = 0
    for piece in pieces:
        if cut is None:
            part = piece(names)
            read += len(part[0])
        else:
            if inside is None:
                whole = dict(zip(names, piece(names), strict=True))
                inside = cut.begun(replace(empty, columns=without_copies(whole)))
            clock = inside.clock.columns
            times = piece([source_of(name, names) for name in clock])
            rows = inside.rows(dict(zip(clock, times, strict=True)))
            part = [values[rows] for values in piece(names)] if len(rows) else []
            kept_rows.append(read + rows)
            read = inside.read
        if part:
            before = kept
            kept += len(part[0])
            _within(empty.path, kept, len(names))
            for column, numbers in zip(columns, part, strict=True):
                if len(column) < kept:
                    # in place: a long log stands in memory once
                    column.resize(kept + kept // 8, refcheck=False)
                column[before:kept] = numbers
        progress(read)
    if inside is not None:
        inside.check(empty.path)
    for column in columns:
        column.resize(kept, refcheck=False)
    found = without_copies(dict(zip(names, columns, strict=True)))
    return replace(empty, columns=found, rows=np.concatenate(kept_rows) if kept_rows else None)


def _within(path: Path, rows: int, columns: int) -> None:
    most = MOST_CELLS // columns
    if rows > most:
        raise InputError(
            f"{path}: more than {most:,} rows of {columns} columns, expected at most so many; take "
            "a stretch of the log (--between 0:600, seconds from its first sample), leave columns "
            "out, or record at 250 Hz, which is enough"
        )
