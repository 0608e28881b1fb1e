"""A log that is being written: its new samples, piece by piece."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.column_map import load_column_map
from irb2400_ctrl.measurement.csv_table import read_csv_table
from irb2400_ctrl.measurement.growing_bag import GrowingBag, bytes_from
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.read_log import read_log
from irb2400_ctrl.measurement.text.csv_dialect import MOST_TITLES

POLL = 0.5
"""[s] between two looks at the file"""
LEAST = 2
"""samples of a piece"""
NOT_LINES = {".gz", ".mat", ".parquet", ".npz", ".h5", ".hdf5", ".db3"}
"""suffixes of files whose end is not theirs to read before they are closed"""


def growing_log(
    path: Path,
    columns: Path | None = None,
    names: Sequence[str] | None = None,
    *,
    quiet: float = 10.0,
) -> Iterator[Log]:
    """What is in a CSV log or an MCAP bag, then what is appended to it; only whole lines are read,
    of a bag whole records.

    Args:
        path: of the log; it may still be empty.
        columns: what its columns are, as in `read_log`.
        names: of the robot's joints, as in `read_log`.
        quiet: ends when nothing came for so long [s]; a bag also where its recorder closed it.

    Raises:
        InputError: neither, not readable, or it became shorter; no sample within `quiet`.
        ToolMissingError: an MCAP bag and no mcap package.
    """
    if path.suffix.lower() in NOT_LINES:
        raise InputError(
            f"{path}: a {path.suffix} file cannot be read while it is written; expected a .csv or "
            "an .mcap (record one, or watch the closed file without --follow)"
        )
    given = None if columns is None else load_column_map(columns)
    if given is not None and given.time is not None and given.time.rate_Hz is not None:
        raise InputError(f"{columns}: a log that grows needs a column of times, found rate_Hz")
    look: Callable[[], Log | None]
    bag = GrowingBag(path, columns, names) if path.suffix.lower() == ".mcap" else None
    read = partial(read_log, columns=columns, names=names)
    look = _Lines(path, read).new if bag is None else bag.new
    begun = False
    waited = 0.0
    while waited < quiet:
        found = look()
        if found is not None:
            begun = True
            waited = 0.0
            yield found
        elif bag is not None and bag.closed:
            break
        else:
            time.sleep(POLL)
            waited += POLL
    if not begun:
        raise InputError(f"{path}: found no samples within {quiet:g} s, expected a log that grows")


class _Lines:
    """The lines of a CSV that were not read yet."""

    def __init__(self, path: Path, reader: Callable[[Path], Log]) -> None:
        self.path = path
        self.reader = reader
        self.head = b""
        self.read = 0

    def new(self) -> Log | None:
        """Their samples; None where there are too few."""
        lines = _whole_lines(self.path, self.read)
        if not self.head and lines.count(b"\n") > MOST_TITLES + LEAST:
            self.head = _head(self.path, lines)
            self.read = len(self.head)
            lines = lines[self.read :]
        if not self.head or lines.count(b"\n") < LEAST:
            return None
        self.read += len(lines)
        # as if the lines were a file of their own
        with _as_file(self.path, self.head + lines) as copy:
            return replace(self.reader(copy), name=str(self.path))


def _whole_lines(path: Path, start: int) -> bytes:
    """Bytes from `start` to the last end of a line."""
    text = bytes_from(path, start)
    return text[: text.rfind(b"\n") + 1]


def _head(path: Path, lines: bytes) -> bytes:
    """The lines above the first sample."""
    with _as_file(path, lines) as copy:
        table = read_csv_table(copy)
    if table.headless:
        raise InputError(f"{path}: a log that grows needs a line of names above its samples")
    if table.first_line is None:
        raise InputError(
            f"{path}: a table of one row per joint cannot be read while it is written; expected a "
            "row per sample, or watch the closed file without --follow"
        )
    return b"".join(lines.splitlines(keepends=True)[: table.first_line - 1])


@contextmanager
def _as_file(path: Path, text: bytes) -> Iterator[Path]:
    """A file that holds these lines alone; what is wrong with them is said of the log."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / path.name
        copy.write_bytes(text)
        try:
            yield copy
        except InputError as error:
            raise InputError(str(error).replace(str(copy), str(path))) from error
