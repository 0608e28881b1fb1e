"""`Stretch`: a part of a log by its clock, and which rows of a file lie in it, piece by piece."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.columns.clock import Clock
from irb2400_ctrl.measurement.table import Table

Rows = npt.NDArray[np.intp]
FORM = "FROM:TO, seconds from the log's first sample, like 100:400, 100: or :400"


@dataclass(frozen=True)
class Stretch:
    """start <= time - time of the file's first row < end.

    Args:
        start: first second that counts [s].
        end: first that does not [s]; infinite: as far as the log goes.

    Raises:
        InputError: a number is below zero or none, or the end is not behind the start.
    """

    start: float
    end: float

    def __post_init__(self) -> None:
        if not (0.0 <= self.start < math.inf and self.start < self.end):
            raise InputError(
                f"a stretch of a log: found {self.start:g} to {self.end:g} s, expected the smaller "
                f"first and none below zero: {FORM}"
            )

    @classmethod
    def of_text(cls, text: str) -> Stretch:
        """`100:400`; `100:` goes as far as the log, `:400` begins with it.

        Raises:
            InputError: another form, or as the class.
        """
        start, colon, end = (part.strip() for part in text.partition(":"))
        try:
            if not colon or start == end:
                raise ValueError
            return cls(float(start or 0.0), float(end or math.inf))
        except ValueError as error:
            raise InputError(f"--between: found {text!r}, expected {FORM}") from error

    def __str__(self) -> str:
        end = "the end" if math.isinf(self.end) else f"{self.end:.10g} s"
        return f"{self.start:.10g} s to {end}"


@dataclass(frozen=True)
class Cut:
    """The rows of a file that lie within a stretch.

    Args:
        stretch: which part.
        clock_of: where a table with the columns of the file holds its time.
    """

    stretch: Stretch
    clock_of: Callable[[Table], Clock]

    def begun(self, table: Table) -> Inside:
        """To be asked piece after piece.

        Args:
            table: of the file, or of its first piece.
        """
        return Inside(self.stretch, self.clock_of(table))

    def of(self, table: Table) -> Table:
        """Those of a whole table.

        Raises:
            InputError: the stretch holds no motion.
        """
        inside = self.begun(table)
        rows = inside.rows(table.columns)
        inside.check(table.path)
        columns = {name: values[rows] for name, values in table.columns.items()}
        return replace(table, columns=columns, rows=rows)


class Inside:
    """Which rows lie in a stretch, piece after piece of a file.

    The clock is read to the file's end: only then is it known not to come back into the stretch.
    """

    def __init__(self, stretch: Stretch, clock: Clock) -> None:
        self.stretch = stretch
        self.clock = clock
        self.read = 0
        self.kept = 0
        self._whole = math.nan
        self._first = math.nan
        self._last = math.nan

    def rows(self, columns: Mapping[str, Array]) -> Rows:
        """Numbers of the rows of the next piece that lie in the stretch, counted in the piece.

        Args:
            columns: at least those of the clock, each (m,).
        """
        first = columns[self.clock.columns[0]]
        if math.isnan(self._whole) and np.isfinite(first).any():
            self._whole = float(first[np.isfinite(first)][0])
        time = self.clock.seconds(columns, self.read, self._whole)
        finite = time[np.isfinite(time)]
        if len(finite):
            self._first = float(finite[0]) if math.isnan(self._first) else self._first
            self._last = float(finite[-1])
        since = time - self._first
        found = np.flatnonzero((self.stretch.start <= since) & (since < self.stretch.end))
        self.read += len(time)
        self.kept += len(found)
        return found

    def check(self, path: Path) -> None:
        """Once the file is read.

        Raises:
            InputError: the stretch holds no motion.
        """
        if self.kept < 2:
            raise InputError(
                f"{path}: found {self.kept} samples from {self.stretch}, expected a stretch of "
                f"the log, which has {self.read:,} samples over {self._last - self._first:.10g} s; "
                f"take {FORM}"
            )
