"""Points among decimal commas: `1.234` may be a thousand there, or a decimal of another writer."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from irb2400_ctrl.errors import InputError

_WITH_POINT = re.compile(r"[+-]?\d*\.\d*(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}\.\d{3}")


@dataclass
class MixedDecimals:
    """What the columns of a file with decimal commas hold, by the number of their cell."""

    commas: set[int] = field(default_factory=set)
    points: set[int] = field(default_factory=set)
    """columns with a point that separates no thousands: `0.5`"""
    doubtful: dict[int, tuple[int, str]] = field(default_factory=dict)
    """the first cell that may be a thousand or a decimal, and its line"""

    def look(self, line: int, cells: Sequence[str]) -> None:
        """At the cells of a line, without quotes."""
        for k, cell in enumerate(cells):
            if "," in cell:
                self.commas.add(k)
            elif "." in cell and _THOUSANDS.fullmatch(cell):
                self.doubtful.setdefault(k, (line, cell))
            elif "." in cell and _WITH_POINT.fullmatch(cell):
                self.points.add(k)

    def check(self, path: Path, header: Sequence[str]) -> None:
        """Refuse a column in which nothing tells what the point is, or both marks stand.

        Raises:
            InputError: the first such cell.
        """
        for k, (line, cell) in self.doubtful.items():
            if k in self.commas or k not in self.points:
                raise InputError(
                    f"{path}, line {line}: found {cell!r} in cell {k + 1} ({header[k]}) of a file "
                    f"with decimal commas; it may be {cell.replace('.', '')} or "
                    f"{cell.replace('.', ',')}: expected one kind of number in a column, without a "
                    "mark between thousands"
                )
