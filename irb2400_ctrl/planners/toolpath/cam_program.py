"""`CamProgram`: what a CAM file holds: operations, each with its tool, way-points and events."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath


@dataclass(frozen=True)
class Tool:
    """A cutter as the file states it; what it leaves out is None or empty."""

    number: int | None = None
    name: str = ""
    diameter: float | None = None
    """[m]"""
    length: float | None = None
    """length, or length to the gauge point, as stated [m]"""
    length_offset: int | None = None
    """register of the length offset (H word, ADJUST)"""


@dataclass(frozen=True)
class Spindle:
    """Speed and direction of the spindle; it stands at speed zero."""

    speed: float = 0.0
    """[rad/s]"""
    clockwise: bool = True
    """seen from the spindle towards the tip (M3, CLW)"""

    @property
    def rpm(self) -> float:
        """[1/min]"""
        return self.speed * 60 / (2 * math.pi)


@dataclass(frozen=True)
class Event:
    """Something at a way-point that moves nothing: coolant, dwell, a stop, a message."""

    kind: str
    point: int
    """index of the way-point it follows; -1: before the first"""
    line: int
    text: str
    seconds: float = 0.0
    """how long the tool waits there (a dwell)"""


@dataclass(frozen=True)
class Note:
    """A line of the file that made no motion, and why."""

    kind: str
    """"ignored": moves nothing, left out by intent; "assumed": read with the stated assumption;
    "unknown": not understood"""
    line: int
    text: str
    count: int = 1
    """how many statements of this kind there are"""

    def __str__(self) -> str:
        more = f" ({self.count} times)" if self.count > 1 else ""
        return f"line {self.line}: {self.text}{more}"


@dataclass(frozen=True)
class Operation:
    """One operation: a motion without tool change, stop or change of the spindle in between."""

    number: int
    name: str
    path: ToolPath
    rapid: npt.NDArray[np.bool_]
    """whether the way to a point is a rapid move (its feed is free), shape (n,)"""
    line: npt.NDArray[np.int64]
    """line of the file that states the point, shape (n,)"""
    tool: Tool = field(default_factory=Tool)
    spindle: Spindle = field(default_factory=Spindle)
    coolant: str = "off"
    """at the first point"""
    frame: Array | None = None
    """pose X_PM of the frame the file states the points in, in the part, shape (4, 4)"""
    events: tuple[Event, ...] = ()

    def __post_init__(self) -> None:
        for value in (self.rapid, self.line, self.frame):
            if value is not None:
                value.setflags(write=False)

    def lengths(self) -> tuple[float, float]:
        """Length of the feed moves and of the rapid moves [m]."""
        ways = np.linalg.norm(np.diff(self.path.position, axis=0), axis=1)
        rapid = self.rapid[1:]
        return float(ways[~rapid].sum()), float(ways[rapid].sum())

    def feed_range(self) -> tuple[float, float] | None:
        """Smallest and largest stated feed [m/s]; None where none is stated."""
        stated = self.path.feed[np.isfinite(self.path.feed)]
        return (float(stated.min()), float(stated.max())) if len(stated) else None

    def summary(self) -> dict[str, Any]:
        """What `irb2400 path show --json` prints of an operation."""
        cut, rapid = self.lengths()
        feed = self.feed_range()
        low = self.path.position.min(axis=0)
        high = self.path.position.max(axis=0)
        tool = self.tool
        return {
            "number": self.number,
            "name": self.name,
            "lines": [int(self.line.min()), int(self.line.max())],
            "tool": {
                "number": tool.number,
                "name": tool.name,
                "diameter_mm": None if tool.diameter is None else 1e3 * tool.diameter,
                "length_mm": None if tool.length is None else 1e3 * tool.length,
                "length_offset": tool.length_offset,
            },
            "spindle_rpm": self.spindle.rpm,
            "spindle": "clockwise" if self.spindle.clockwise else "counter-clockwise",
            "coolant": self.coolant,
            "points": len(self.path),
            "rapid_moves": int(self.rapid[1:].sum()),
            "cutting_length_mm": 1e3 * cut,
            "rapid_length_mm": 1e3 * rapid,
            "feed_mm_s": None if feed is None else [1e3 * f for f in feed],
            "extent_mm": [[float(1e3 * v) for v in low], [float(1e3 * v) for v in high]],
            "frame": None if self.frame is None else self.frame.tolist(),
            "events": [vars(event) for event in self.events],
        }


@dataclass(frozen=True)
class CamProgram:
    """All operations of a file in one frame: the one that the file states for the first of them."""

    name: str
    dialect: str
    operations: tuple[Operation, ...]
    notes: tuple[Note, ...] = ()
    units: str = "mm"
    units_stated: bool = True
    """whether the file itself leaves no doubt about its unit of length"""

    def operation(self, choice: int | str | None = None) -> Operation:
        """The operation of this number or name; without a choice the only one.

        Raises:
            InputError: no such operation, or several; lists them.
        """
        if choice is None:
            found = list(self.operations)
        else:
            text = str(choice).strip()
            found = [o for o in self.operations if o.name == text]
            if not found and text.isdecimal():
                found = [o for o in self.operations if o.number == int(text)]
        if len(found) == 1:
            return found[0]
        listed = "; ".join(f"{o.number}: {o.name}" for o in self.operations[:20])
        if len(self.operations) > 20:
            listed += f"; and {len(self.operations) - 20} more"
        asked = "" if choice is None else f" called {choice!r}"
        raise InputError(
            f"{self.name}: found {len(found)} operations{asked}, expected one; choose by number or "
            f"by name (operation=…, --operation …): {listed}"
        )

    def of_kind(self, kind: str) -> list[Note]:
        """The notes of one kind."""
        return [note for note in self.notes if note.kind == kind]

    def summary(self) -> dict[str, Any]:
        """What `irb2400 path show --json` prints."""
        return {
            "schema_version": 1,
            "file": self.name,
            "dialect": self.dialect,
            "units": self.units,
            "operations": [o.summary() for o in self.operations],
            "notes": [vars(note) for note in self.notes],
        }
