"""Measurement files of LabVIEW (`.lvm`) as the text of a table: one line of names, rows below it.

Two headers stand above the samples, each closed by `***End_of_Header***`: of the file (separator,
how many columns of times), and of the channels (their units, first time and step). The last column
is a comment.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.reading.text_blocks import text_blocks

FIRST = b"LabVIEW Measurement"
END = "***End_of_Header***"
SPECIAL = "***Start_Special***", "***End_Special***"
SEPARATOR = "Separator"


def lvm_blocks(path: Path) -> Iterator[bytes]:
    """The file as UTF-8, whole lines in every block; line k is line k of the file, empty where a
    header stands. A file without its headers is passed on as it is.

    Raises:
        InputError: as `text_blocks`; channels with times of their own; several packets of which
            one states no times.
    """
    blocks = text_blocks(path)
    first = next(blocks, b"")
    if not first.startswith(FIRST):
        yield first
        yield from blocks
        return
    rows = _Rows(path)
    block: bytes | None = first
    while block is not None:
        yield "\n".join([rows.of(line) for line in block.decode().split("\n")[:-1]] + [""]).encode()
        block = next(blocks, None)


@dataclass
class _Rows:
    """Line by line: what a line of the file is in the table."""

    path: Path
    separator: str = "\t"
    tags: dict[str, list[str]] | None = None
    """of the header that is being read; None below it"""
    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    kind: str = "Time"
    """of the X column"""
    times: str = "one"
    """columns of them: one, no, multi"""
    packets: int = 0
    samples: int = 0
    special: bool = False
    first: float = 0.0
    step: float = 0.0
    comma: bool = False

    def of(self, line: str) -> str:
        """The line of the table."""
        bare = line.strip()
        if bare in SPECIAL or self.special:
            self.special = bare != SPECIAL[1] and (self.special or bare == SPECIAL[0])
            return ""
        if bare.startswith(FIRST.decode()):
            self.tags = {}
            return ""
        if self.tags is not None and bare[: len(SEPARATOR)] == SEPARATOR != bare:
            self.separator = bare[len(SEPARATOR)]  # which stands in this line, too
        cells = [cell.strip().strip('"') for cell in line.split(self.separator)]
        if cells[0] == "Channels" and self.tags is None:
            self.tags = {}
        if self.tags is not None:
            self._header(cells)
            return ""
        if cells[0] == "X_Value":
            return self._named(cells)
        if not self.names or not any(cells):
            return ""
        return self.separator.join(self._sample(cells))

    def _header(self, cells: list[str]) -> None:
        """A line of a header: a tag and what it says, of each channel."""
        assert self.tags is not None
        if cells[0] != END:
            self.tags[cells[0]] = cells[1:]
            return
        if "Channels" not in self.tags:
            self.times = self._said("X_Columns", "One").lower()
            self.comma = self._said("Decimal_Separator", ".") == ","
        else:
            self._packet()
            self.units = tuple(self.tags.get("Y_Unit_Label", []))
            self.kind = self._said("X_Dimension", "Time")
        self.tags = None

    def _packet(self) -> None:
        """Of channels that are sampled together."""
        assert self.tags is not None
        self.packets += 1
        starts = {cell for cell in self.tags.get("X0", []) if cell}
        steps = {cell for cell in self.tags.get("Delta_X", []) if cell}
        if self.times == "multi" and (len(starts) > 1 or len(steps) > 1):
            raise InputError(
                f"{self.path}: found channels with times of their own, expected one time for all: "
                "write the file with one X column (or none) from LabVIEW"
            )
        if self.times != "no":
            return
        if self.packets > 1:
            raise InputError(
                f"{self.path}: found several packets without times, expected one, or an X column: "
                "write the file with one X column from LabVIEW"
            )
        self.first = self._number(next(iter(starts), "0"))
        self.step = self._number(next(iter(steps), "0"))
        if not self.step > 0.0:
            raise InputError(
                f"{self.path}: found no X column and no Delta_X, expected one of them: write the "
                "file with one X column from LabVIEW"
            )

    def _named(self, cells: list[str]) -> str:
        """The line of names; those of a later packet have to be the same."""
        while cells and cells[-1] in {"", "Comment"}:
            cells.pop()
        pairs = self.times == "multi"
        channels = cells[1::2] if pairs else cells[1:]
        stated = self.units
        if pairs and not any(stated[1::2]):
            stated = stated[::2]  # above the column of each channel, none above those of the times
        units = [*stated, *[""] * len(channels)]
        named = [_with_unit(name, unit) for name, unit in zip(channels, units, strict=False)]
        names = ("time_s" if self.kind == "Time" else cells[0], *named)
        if self.names and names != self.names:
            raise InputError(
                f"{self.path}: found packets of other channels ({', '.join(names[1:4])}…), "
                "expected the same in all: write them to files of their own"
            )
        told = not self.names
        self.names = names
        return self.separator.join(names) if told else ""

    def _sample(self, cells: list[str]) -> list[str]:
        """A row of the table: a time and a value of each channel, without the comment."""
        if self.times == "multi":
            cells = [cells[0], *cells[1::2]]
        elif self.times == "no":
            time = f"{self.first + self.samples * self.step:.9f}"
            cells[0] = time.replace(".", ",") if self.comma else time
        self.samples += 1
        return cells[: len(self.names)]

    def _said(self, tag: str, default: str) -> str:
        assert self.tags is not None
        return next(iter(self.tags.get(tag, [])), "") or default

    def _number(self, cell: str) -> float:
        try:
            return float(cell.replace(",", "."))
        except ValueError:
            return 0.0


def _with_unit(name: str, unit: str) -> str:
    """`angle 1 [deg]`; a name that says its unit stays."""
    if not unit or name.lower().rstrip(")]").endswith(unit.lower()):
        return name
    return f"{name} [{unit}]"
