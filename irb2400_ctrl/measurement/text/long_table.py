"""Tables of one row per joint and sample (`Time, Joint Name, Position, Velocity, Effort`), as tidy
data are kept: rows of one time become one row, with the columns `elbow/position`… of recorders."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.text.csv_dialect import EMPTY, Dialect, dialect_of, is_number
from irb2400_ctrl.measurement.text.echoed_topic import PARTS

Text = Callable[[Path], Iterator[bytes]]
"""the lines of a file, whole lines in every block"""
_NAME = re.compile(r"(joint[ _]?)?name|joint", re.IGNORECASE)
_STAMP = re.compile(
    r"(.*[/._ ])?%?(__)?(time|stamp|timestamp|n?secs?|nanosec)(_\w+)?", re.IGNORECASE
)


@dataclass(frozen=True)
class LongTable:
    """Where such a table holds what.

    Args:
        dialect: of its lines, with the header in line `skip`.
        width: cells of a line.
        name: place of the joint's name in a line, from 0.
        stamps: places of the time, with the names of these columns.
        parts: place of `position`, `velocity`, `effort`, those that it has.
        joints: names, in the order of the first rows.
    """

    dialect: Dialect
    width: int
    name: int
    stamps: dict[int, str]
    parts: dict[str, int]
    joints: tuple[str, ...]

    def rows(self, path: Path, text: Text) -> Iterator[bytes]:
        """The table as lines of one sample each, the header first.

        A joint that the first rows do not name is another publisher's, and left aside; one that a
        sample does not have leaves its cells empty. A last sample that lacks joints was being
        written when the recorder stopped: it is left out.

        Raises:
            InputError: a line of another width.
        """
        comma = self.dialect.separator
        names = [f"{joint}/{part}" for joint in self.joints for part in self.parts]
        known = frozenset(self.joints)
        lines = [comma.join([*self.stamps.values(), *names])]
        stamp: list[str] = []
        sample: dict[str, list[str]] = {}
        whole: set[frozenset[str]] = set()
        blank = [""] * len(self.parts)

        def written() -> str:
            found = [cell for joint in self.joints for cell in sample.get(joint, blank)]
            return comma.join([*stamp, *found])

        for block in self._cells(path, text):
            for cells in block:
                joint = cells[self.name]
                now = [cells[k] for k in self.stamps]
                if joint not in known:
                    continue
                if sample and (now != stamp or joint in sample):
                    lines.append(written())
                    whole.add(frozenset(sample))
                    sample = {}
                stamp = now
                sample[joint] = [cells[k] for k in self.parts.values()]
            yield _block(lines)
            lines = []
        cut = any(sample.keys() < other for other in whole)
        yield _block([] if cut or not sample else [written()])

    def _cells(self, path: Path, text: Text) -> Iterator[Iterator[list[str]]]:
        """Of the lines below the header, block by block; not of a last line that was cut.

        Raises:
            InputError: a line of another width.
        """
        number = 0
        torn: InputError | None = None

        def of(block: bytes) -> Iterator[list[str]]:
            nonlocal number, torn
            for line in block.decode().split("\n")[:-1]:
                number += 1
                if number <= self.dialect.skip + 1 or not line.strip(EMPTY):
                    continue
                if torn is not None:
                    raise torn
                cells = self.dialect.cells(line)
                if len(cells) == self.width:
                    yield cells
                    continue
                torn = InputError(
                    f"{path}, line {number}: found {len(cells)} cells, expected {self.width} as in "
                    "the header"
                )
                if len(cells) > self.width:
                    raise torn

        for block in text(path):
            yield of(block)


def long_table(path: Path, text: Text) -> LongTable | None:
    """Of a file with these lines; None where a row is a sample.

    Raises:
        InputError: no line could be a header.
    """
    lines = next(text(path), b"").decode().split("\n")[:-1]
    dialect = dialect_of(path, lines)
    header = dialect.cells(lines[dialect.skip])
    places = [k for k, name in enumerate(header) if _NAME.fullmatch(name)]
    parts = {part: k for part in PARTS for k, name in enumerate(header) if name.lower() == part}
    stamps = {k: name for k, name in enumerate(header) if _STAMP.fullmatch(name)}
    if len(places) != 1 or "position" not in parts or not stamps:
        return None
    rows = (dialect.cells(line) for line in lines[dialect.skip + 1 :] if line.strip(EMPTY))
    words = [row[places[0]] for row in rows if len(row) == len(header)]
    joints = tuple(dict.fromkeys(word for word in words if word))
    if len(joints) < 2 or len(joints) == len(words) or any(_other(w, dialect) for w in joints):
        return None
    return LongTable(dialect, len(header), places[0], stamps, parts, joints)


def _other(cell: str, dialect: Dialect) -> bool:
    """Whether a cell is no joint's name: a number, or a list of all names."""
    return is_number(cell, dialect) or cell[:1] in "[("


def _block(lines: list[str]) -> bytes:
    return "".join(f"{line}\n" for line in lines).encode()
