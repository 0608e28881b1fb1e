"""`ProgramBuilder`: the state of an imagined machine, and the operations it has been told to do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import PurePath

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram, Event, Spindle, Tool
from irb2400_ctrl.planners.toolpath.readers.expansion import arcs
from irb2400_ctrl.planners.toolpath.readers.expansion.arcs import Arc
from irb2400_ctrl.planners.toolpath.readers.feed import Feed
from irb2400_ctrl.planners.toolpath.readers.notes import Notes
from irb2400_ctrl.planners.toolpath.readers.operation_draft import FROM_ABOVE, Draft, finished
from irb2400_ctrl.planners.toolpath.readers.unread_line import (
    TooMuchError,
)

CHORD = 5e-5
# a cut in which the tip goes less for each radian of turning has no feed to speak of [m/rad]
ON_THE_SPOT = 1e-4
MOST_POINTS = 2_000_000
UP = np.array([0.0, 0.0, 1.0])


class ProgramBuilder(Notes):
    """Collects moves, events and notes while a reader walks through a file.

    A tool change, a stop, a change of the spindle and a new name begin a new operation. Lengths in
    metres, speeds in m/s.
    """

    def __init__(
        self,
        name: str,
        *,
        chord: float = CHORD,
        most_points: int = MOST_POINTS,
        strict: bool = True,
        default_name: str = "",
        default_spindle: float = 0.0,
    ) -> None:
        if not chord > 0:
            raise InputError(f"chord: found {chord} m, expected a positive length")
        super().__init__(name, strict=strict)
        self.default_name = default_name
        self.default_spindle = default_spindle
        self.chord = chord
        self.most_points = most_points
        self.here: Array | None = None
        self.axis = UP
        self.feed = Feed()
        self.tool = Tool()
        self.spindle = Spindle()
        self.coolant = "off"
        self.frame = np.eye(4)
        self.stated_frame = False
        self.operation_name = ""
        self.on_profile = False
        """the points are those of the part's edge, where cutter compensation is on (Creo)"""
        self.tool_described = False
        """something was said about the tool since the last motion"""
        self._points = 0
        self._done: list[Draft] = []
        self._feedless = False
        self._from_above = False
        """the tool is another one, and its height is not stated yet"""
        self._draft = self._new_draft()

    @property
    def points(self) -> int:
        """How many points there are so far."""
        return self._points

    @property
    def moved(self) -> bool:
        """Whether the tool has moved at all."""
        return self._points > 0

    def begin_operation(self, name: str) -> None:
        """The file names what comes next."""
        self.operation_name = name.strip()
        self._split(keep_place=False)

    def change_tool(self, tool: Tool) -> None:
        """Another tool, or more said of this one before it has moved; behind a motion the spindle
        and the coolant stop."""
        self.tool = tool
        self.tool_described = True
        self._split(keep_place=False)
        self._from_above = self.moved
        if self.moved and (self.spindle.speed > 0 or self.coolant != "off"):
            self.assume("a change of tool stops spindle and coolant until stated again")
            self.set_spindle(Spindle(0.0, self.spindle.clockwise))
            self.set_coolant("off")
        text = f"{'' if tool.number is None else tool.number} {tool.name}".strip()
        if all((event.kind, event.text) != ("tool", text) for event in self._draft.events):
            self._draft.events.append(Event("tool", -1, self.line, text))

    def describe_tool(self, tool: Tool) -> None:
        """More about the tool; after motion it is the next one."""
        self.tool = tool
        self.tool_described = True
        if len(self._draft.position) > 1:
            self._split(keep_place=False)
        self._draft.tool = tool

    def set_spindle(self, spindle: Spindle) -> None:
        """Start, stop or turn the spindle; the tool waits until it has its speed, and does not wait
        for it to stop."""
        if spindle == self.spindle:
            return
        turned = self.spindle.speed > 0
        self.spindle = spindle
        if spindle.speed > 0:
            self._split(keep_place=True)
        elif turned:
            self.event("spindle", "off")
        if not self._draft.position:
            self._draft.spindle = spindle

    def set_coolant(self, state: str) -> None:
        """Coolant on or off: the tool does not wait."""
        ends = state == "off" != self.coolant
        self.coolant = state
        if not self._draft.position:
            self._draft.coolant = state
        if self._draft.position or ends:
            self.event("coolant", state)

    def set_frame(self, X_PM: Array) -> None:
        """The frame in which the next points are stated, in the part."""
        if self.here is not None:
            X = np.linalg.inv(X_PM) @ self.frame
            self.here = X[:3, :3] @ self.here + X[:3, 3]
        self.frame = X_PM
        self.stated_frame = True
        self._split(keep_place=False)

    def stop(self, kind: str, text: str) -> None:
        """The program waits for the operator."""
        self.event(kind, text)
        self._split(keep_place=True)

    def leave(self) -> None:
        """The tool goes to a place that the file does not state in the part's frame."""
        self._split(keep_place=False)
        self.here = None

    def set_length_offset(self, register: int) -> None:
        """The register of the tool's length offset; the same tool, the same operation."""
        self.tool = replace(self.tool, length_offset=register)
        self._draft.tool = replace(self._draft.tool, length_offset=register)

    def event(self, kind: str, text: str) -> None:
        """Something happens at the last point."""
        self._draft.events.append(Event(kind, len(self._draft.position) - 1, self.line, text))

    def dwell(self, seconds: float) -> None:
        """The tool waits at the last point."""
        point = len(self._draft.position) - 1
        self._draft.events.append(Event("dwell", point, self.line, f"{seconds:g} s", seconds))

    def move(
        self,
        position: Array,
        *,
        axis: Array | None = None,
        rapid: bool = False,
        height: bool = True,
    ) -> None:
        """A straight move of the tool tip; `height` is whether the file states it here."""
        self._begin_cut(rapid)
        self._from_above &= not height
        self._draft.carried += self._from_above
        length = 0.0 if self.here is None else float(np.linalg.norm(position - self.here))
        axis = self.axis if axis is None else axis
        self._turn(length, float(np.linalg.norm(axis - self.axis)), rapid)
        self.axis = axis
        self._append(position, self._speed(length, rapid), rapid)

    def start(self, position: Array, axis: Array | None = None) -> None:
        """The tool is there already."""
        self.axis = self.axis if axis is None else axis
        self._append(position, np.inf, True)

    def arc(self, arc: Arc, end: Array, *, axis: Array | None = None, rapid: bool = False) -> None:
        """A circular or helical move.

        Raises:
            InputError: the ends do not lie on one circle about the axis.
        """
        if self.here is None:
            raise InputError("an arc begins, but the tool's place is not known yet")
        start = self.here
        if arcs.checked_miss(arc, start, end) > arcs.EXPECTED_MISS:
            self.assume("start, end and radius of an arc differ by rounding; both ends are met")
        self._begin_cut(rapid, curved=True)
        if self._points + arcs.count(arc, start, end, self.chord) > self.most_points:
            self._too_many()
        places = arcs.points(arc, start, end, self.chord)
        length = float(np.linalg.norm(np.diff(np.vstack([start, places]), axis=0), axis=1).sum())
        axes = arcs.blended_axes(self.axis, axis, len(places))
        self._curve(places, axes, self._speed(length, rapid), rapid)

    def curve(self, places: Array, axes: Array | None, *, rapid: bool = False) -> None:
        """A polyline that stands for a curve from where the tool is."""
        if self.here is None:
            raise InputError("a curve begins, but the tool's place is not known yet")
        self._begin_cut(rapid, curved=True)
        length = float(
            np.linalg.norm(np.diff(np.vstack([self.here, places]), axis=0), axis=1).sum()
        )
        known = np.tile(self.axis, (len(places), 1)) if axes is None else axes
        turns = np.diff(np.vstack([self.axis, known]), axis=0)
        self._turn(length, float(np.linalg.norm(turns, axis=1).sum()), rapid)
        self._curve(places, known, self._speed(length, rapid), rapid)

    def finish(self, dialect: str, units: str, units_stated: bool) -> CamProgram:
        """The operations that move the tool, all in the frame of the first of them.

        Raises:
            InputError: there is none, and the caller does not only look at the file.
        """
        self._split(keep_place=False)
        if not self._done and self.strict:
            raise InputError(
                f"{self.name}: found {min(self._points, 1)} point(s) of motion, expected at least "
                "2 (GOTO/… in APT, G0 or G1 in G-code)"
            )
        if any(not np.array_equal(d.frame, self._done[0].frame) for d in self._done):
            self.assume("points in several frames: all brought into the first one")
        name = PurePath(self.name).name
        done = finished(self._done, self.default_name)
        return CamProgram(name, dialect, done, self.notes(), units, units_stated)

    def _new_draft(self) -> Draft:
        frame = (self.frame, self.stated_frame)
        return Draft(self.operation_name, self.tool, self.spindle, self.coolant, *frame)

    def _split(self, *, keep_place: bool) -> None:
        """End the operation in hand; the next one begins where it ends if the tool stays there."""
        old = self._draft
        moves = old.moves
        if old.begin_above():
            self._add("assumed", old.line[0], FROM_ABOVE)
        if moves:
            self._done.append(old)
        self._draft = self._new_draft()
        if not moves:
            self._draft.events = [replace(event, point=-1) for event in old.events]
            if len(old.position) == 1 and not keep_place and not old.continues:
                self.line = max(self.line, old.line[0])
                self.assume("a single point without a way to it makes no operation")
        if keep_place and self.here is not None and old.position:
            self._draft.continues = True
            self._append(self.here, np.inf, True, old.line[-1])
            self._draft.carried += self._from_above

    def _begin_cut(self, rapid: bool, curved: bool = False) -> None:
        """A cut at the start of an operation begins where the tool is; not with another tool, which
        comes from its magazine. A curve needs its start in any case."""
        self._from_above &= rapid and not curved
        changed = bool(self._done) and self._done[-1].tool != self._draft.tool
        begins = not self._draft.position and self.here is not None
        if begins and self.here is not None and (curved or not (rapid or changed)):
            self._append(self.here, np.inf, True)
        elif begins and not rapid:
            self.assume(
                "a cut first behind a change of tool is begun at its end: where the tool comes "
                "from is not stated"
            )

    def _speed(self, length: float, rapid: bool) -> float:
        if rapid:
            return np.inf
        try:
            speed = self.feed.speed(length, self.spindle.speed or self.default_spindle)
        except InputError as error:
            # whoever only looks at the file shall see the point all the same
            if self.strict:
                raise
            self.failed(error)
            return np.inf
        if not np.isfinite(speed) and not self._feedless and self.here is not None:
            self._feedless = True
            self.assume("a cut without a stated feed is not limited in speed")
        return speed

    def _turn(self, length: float, turn: float, rapid: bool) -> None:
        """What is said of a cut that turns the tool by an angle [rad] on hardly any way [m]."""
        if self._draft.position and not rapid and length < ON_THE_SPOT * turn:
            self.assume(self.feed.turning_alone())

    def _curve(self, places: Array, axes: Array, speed: float, rapid: bool) -> None:
        for place, axis in zip(places, axes, strict=True):
            self.axis = axis
            self._append(place, speed, rapid)

    def _append(self, position: Array, speed: float, rapid: bool, line: int | None = None) -> None:
        self._points += 1
        if self._points > self.most_points:
            self._too_many()
        if not np.abs(position).max() < 1e3:
            raise InputError(
                f"the point lies {np.abs(position).max():.3g} m away, expected less "
                "than 1000 m; check the numbers and the unit of length"
            )
        self.tool_described = False
        draft = self._draft
        draft.position.append(position)
        draft.axis.append(self.axis)
        draft.feed.append(speed)
        draft.rapid.append(rapid)
        draft.line.append(self.line if line is None else line)
        self.here = position

    def _too_many(self) -> None:
        raise TooMuchError(
            self.line,
            f"the file makes more than {self.most_points:,} points; choose a larger "
            "chord tolerance, or split the file",
        )
