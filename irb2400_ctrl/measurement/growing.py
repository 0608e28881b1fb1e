"""A log that is being written: its new samples, piece by piece."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.csv_table import MOST_TITLES, read_csv_table
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.read_log import read_log

POLL = 0.5
"""[s] between two looks at the file"""
LEAST = 2
"""samples of a piece"""
NOT_LINES = {".gz", ".mat", ".parquet", ".db3", ".mcap"}
"""suffixes of files whose end is not theirs to read before they are closed"""


def growing_log(
    path: Path,
    columns: Path | None = None,
    names: Sequence[str] | None = None,
    *,
    quiet: float = 10.0,
) -> Iterator[Log]:
    """What is in a CSV log, then what is appended to it; only whole lines are read.

    Args:
        path: of the log; it may still be empty.
        columns: what its columns are, as in `read_log`.
        names: of the robot's joints, as in `read_log`.
        quiet: ends when nothing came for so long [s].

    Raises:
        InputError: not a CSV, not readable, or it became shorter; no sample within `quiet`.
    """
    if path.suffix.lower() in NOT_LINES:
        raise InputError(
            f"{path}: a {path.suffix} file cannot be read while it is written; expected a .csv "
            "(record one, or watch the closed file without --follow)"
        )
    head = b""
    read = 0
    waited = 0.0
    while waited < quiet:
        lines = _whole_lines(path, read)
        if not head and lines.count(b"\n") > MOST_TITLES + LEAST:
            head = _head(path, lines)
            read = len(head)
            lines = lines[read:]
        if not head or lines.count(b"\n") < LEAST:
            time.sleep(POLL)
            waited += POLL
            continue
        waited = 0.0
        read += len(lines)
        yield _parsed(path, head + lines, columns, names)
    if not head:
        raise InputError(f"{path}: found no samples within {quiet:g} s, expected a log that grows")


def _whole_lines(path: Path, start: int) -> bytes:
    """Bytes from `start` to the last end of a line."""
    size = path.stat().st_size
    if size < start:
        raise InputError(
            f"{path}: found {size} bytes where {start} were, expected a file that only grows; "
            "watch the new file"
        )
    with path.open("rb") as file:
        file.seek(start)
        text = file.read()
    return text[: text.rfind(b"\n") + 1]


def _head(path: Path, lines: bytes) -> bytes:
    """The lines above the first sample."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(lines)
        first = read_csv_table(copy).first_line or 1
    return b"".join(lines.splitlines(keepends=True)[: first - 1])


def _parsed(path: Path, text: bytes, columns: Path | None, names: Sequence[str] | None) -> Log:
    """As if the lines were a file of their own."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(text)
        return replace(read_log(copy, columns=columns, names=names), name=str(path))
