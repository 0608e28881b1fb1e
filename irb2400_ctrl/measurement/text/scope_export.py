"""Text that TwinCAT Scope exports: blocks of lines about the file and about each channel, then rows
of a time in milliseconds and the channels' values.

    Name<tab>q1<tab>q2 …      SampleTime[ms]<tab>4<tab>4 …      Unit<tab>deg<tab>deg …
    0<tab>0,105<tab>-0,2 …    (a time in front of every channel where each has its own: one where
                              all say the same)

Without this, port and sample time are rows of a table whose columns are called `Name`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from irb2400_ctrl.errors import InputError

Text = Callable[[Path], Iterator[bytes]]

_MARK = "SampleTime[ms]"
_MOST_LINES = 60
_TICKS = 1e12
"""[ms] that no offset reaches: a time in ticks of Windows"""


@dataclass(frozen=True)
class ScopeExport:
    """An export as a table with one header line.

    Args:
        header: its text.
        skip: lines before the first sample.
        separator: of its cells.
        times: places of the times, from 0.
    """

    header: str
    skip: int
    separator: str
    times: tuple[int, ...]

    def rows(self, path: Path, text: Text) -> Iterator[bytes]:
        """The lines of the table.

        Raises:
            InputError: channels whose times differ.
        """
        blocks = text(path)
        first = next(blocks).split(b"\n", self.skip)[-1]
        number = self.skip
        head = f"{self.header}\n".encode()
        for block in chain([first], blocks):
            # a mark at the end is no sample
            ends = block[-8:].rstrip().endswith(b"EOF")
            told = block.rstrip().removesuffix(b"EOF") if ends else block
            yield head + (told if len(self.times) == 1 else self._one_time(path, told, number))
            head = b""
            number += block.count(b"\n")

    def _one_time(self, path: Path, block: bytes, number: int) -> bytes:
        """Lines with the first of their times alone.

        Raises:
            InputError: the times of a line differ.
        """
        mark = self.separator.encode()
        lines = []
        for k, line in enumerate(block.split(b"\n"), number + 1):
            cells = line.split(mark)
            stamps = [cells[place] for place in self.times if place < len(cells)]
            if len(set(stamps)) > 1:
                other = next(stamp for stamp in stamps if stamp != stamps[0]).decode()
                raise InputError(
                    f"{path}, line {k}: found an export of TwinCAT Scope with channels of "
                    f"different times ({stamps[0].decode()} and {other!r} ms), expected one time "
                    "for all: record all channels at one sample time, or export with Timelines: "
                    "For each sampletime"
                )
            further = set(self.times[1:])
            lines.append(mark.join(c for place, c in enumerate(cells) if place not in further))
        return b"\n".join(lines)


def scope_export(path: Path, text: Text) -> ScopeExport | None:
    """Of a file with these lines; None where another recorder wrote it.

    Raises:
        InputError: times that are no offsets.
    """
    lines = [line.rstrip("\r") for line in next(text(path), b"").decode().split("\n")]
    marks = [k for k, line in enumerate(lines[:_MOST_LINES]) if line.startswith(_MARK)]
    if not marks:
        return None
    separator = lines[marks[0]][len(_MARK) : len(_MARK) + 1]
    about = [line.split(separator) for line in lines[: marks[0] + _MOST_LINES]]
    names = next((k for k in range(marks[0], -1, -1) if about[k][0] == "Name"), None)
    first = next((k for k in range(marks[0], len(about)) if about[k][0][:1].isdigit()), None)
    if not separator or names is None or first is None:
        return None
    times = [k for k, cell in enumerate(about[names]) if cell == "Name"]
    told = next((row for row in about[names:first] if row[0] == "Unit"), [])
    if not _is_offset(about[first][0]):
        raise InputError(
            f"{path}: found an export of TwinCAT Scope with full time stamps; expected offsets in "
            "milliseconds: export it without Full Timestamp"
        )
    units = [*told, *[""] * len(about[names])]
    cells = zip(about[names], units, strict=False)
    named = [_named(name, unit) for k, (name, unit) in enumerate(cells) if k not in times]
    return ScopeExport(separator.join(["time_ms", *named]), first, separator, tuple(times))


def _is_offset(cell: str) -> bool:
    """Whether a time counts from the start; no clock time, and no ticks of Windows."""
    try:
        return float(cell.replace(",", ".")) < _TICKS
    except ValueError:
        return False


def _named(name: str, unit: str) -> str:
    """With the unit of a channel whose name has none."""
    return f"{name} [{unit}]" if unit.strip() and "_" + unit.strip() not in name else name
