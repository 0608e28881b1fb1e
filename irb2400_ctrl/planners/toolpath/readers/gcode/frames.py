"""Codes that move the frame of the coordinates: G52, G92, G68, G68.2, and what ends them; the
programmed frames TRANS, ATRANS, ROT, AROT (Siemens).
"""

from __future__ import annotations

import math

import numpy as np

from irb2400_ctrl.arrays import Array, rotation_about
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import tilted_plane
from irb2400_ctrl.planners.toolpath.readers.gcode.state import AXES, ROTARY, GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

CODES = frozenset([52, 68, 68.2, 69, 92, 92.1, 92.2])
PROGRAMMED = ("TRANS", "ATRANS", "ROT", "AROT")


class GcodeFrames:
    """Carries them out on the state; the tool stays where it is."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState) -> None:
        self._builder = builder
        self._state = state
        self._shifted: set[str] = set()
        """axes of which G52 or G92 moved the zero"""
        self._unturned = 0
        """line of a tilted plane that no G53.1 has turned the tool to"""

    def run(
        self, codes: list[float], values: dict[str, float], words: tuple[str, ...] = ()
    ) -> bool:
        """Whether one of the codes or written orders took the words of the block for itself."""
        state = self._state
        for word in words:
            if word in PROGRAMMED:
                self._programmed(word, values)
                return True
        if 53.1 in codes:
            self._unturned = 0
        if 69 in codes:
            self.end()
            state.reframe(plane_pose=np.eye(4), turned=np.eye(4))
            state.turned_by_file = False
        if {92.1, 92.2} & set(codes):
            self._end_shift(set(AXES) & set(values))
            return True
        orders = {68.2: self._tilt, 68: self._turn, 52: self._local, 92: self._shift}
        found = [code for code in codes if code in orders]
        for code in found:
            orders[code](values)
        return bool(found)

    def end(self) -> None:
        """A tilted plane is left: said where the file turns the tool to it in no way."""
        builder = self._builder
        if self._unturned and not self._state.turned_by_file:
            line = builder.line
            builder.line = self._unturned
            builder.assume(
                "G68.2 without G53.1 behind it and without angles of the axes: the tool is taken "
                "as turned to the plane, which a control does not do by itself"
            )
            builder.line = line
        self._unturned = 0

    def _end_shift(self, named: set[str]) -> None:
        """G92.1, with the axes that it names (Fanuc).

        Raises:
            InputError: the zero of an axis that is not among them was moved, too.
        """
        if named and not self._shifted <= named:
            raise InputError(
                f"G92.1 with {min(named)} ends the moved zero of some "
                f"axes only (Fanuc), that of {min(self._shifted - named)} stays; not read, "
                f"expected G92.1 alone, or with {', '.join(sorted(self._shifted | named))}"
            )
        self._shifted.clear()
        self._state.reframe(offset=np.eye(4))

    def _tilt(self, values: dict[str, float]) -> None:
        """G68.2 X Y Z I J K."""
        if "P" in values:
            raise InputError("G68.2 P… is not read; expected X Y Z I J K (Euler angles)")
        self.end()
        X = tilted_plane(values, self._state.unit)
        self._unturned = 0 if np.allclose(X[:3, 2], [0, 0, 1]) else self._builder.line
        self._state.left_turned = False
        self._state.reframe(plane_pose=X)

    def _turn(self, values: dict[str, float]) -> None:
        """G68 X Y R: coordinates turned in the plane about a point of it."""
        state = self._state
        if "R" not in values or state.plane != 17 or set("ZIJKABC") & set(values):
            raise InputError("G68 is read as G17 G68 X Y R only")
        if not state.absolute and not np.array_equal(state.turned, np.eye(4)):
            raise InputError(
                f"G68 R{values['R']:g} in G91 while coordinates are turned: some controls turn on "
                "by R (Haas, Fanuc by a parameter), others to R; expected G90, or G69 before it"
            )
        state.reframe(turned=np.eye(4))
        centre = np.zeros(3)
        for index, letter in enumerate("XY"):
            known = state.at[index]
            if letter in values:
                centre[index] = values[letter] * state.unit
            elif known is not None:
                centre[index] = known
            else:
                raise InputError(f"G68 without {letter}, and the tool's is not stated yet")
        X = np.eye(4)
        X[:3, :3] = rotation_about(2, math.radians(values["R"]))
        X[:3, 3] = centre - X[:3, :3] @ centre
        state.reframe(turned=X)

    def _programmed(self, order: str, values: dict[str, float]) -> None:
        """TRANS X Y Z and ROT Z or RPL= begin anew, ATRANS and AROT go on from where the frame is;
        without words there is none.

        Raises:
            InputError: a rotation about X or Y, at which the tool need not turn as well.
        """
        state = self._state
        known = {"Z", "RPL"} if order.endswith("ROT") else set(AXES)
        others = sorted(set(values) - known)
        if others or (state.plane != 17 and order.endswith("ROT") and values):
            shown = others[0] if others else f"in the plane G{state.plane}"
            raise InputError(
                f"{order} {shown} is not read; expected TRANS X Y Z, or ROT Z or RPL= in "
                "G17 (a plane that the tool turns to: CYCLE800)"
            )
        X = np.eye(4)
        if order.endswith("ROT"):
            X[:3, :3] = rotation_about(2, math.radians(values.get("RPL", values.get("Z", 0.0))))
        else:
            X[:3, 3] = [state.unit * values.get(letter, 0.0) for letter in AXES]
        state.reframe(turned=state.turned @ X if order.startswith("A") else X)

    def _local(self, values: dict[str, float]) -> None:
        """G52 X Y Z: the zero lies there in the work frame; zeros end it."""
        state = self._state
        self._no_turned_zero(52, values)
        offset = state.offset.copy()
        for index, letter in enumerate(AXES):
            if letter in values:
                offset[index, 3] = values[letter] * state.unit
                if values[letter] != 0:
                    self._shifted.add(letter)
        self._builder.assume("G52: the zero is moved by what it states")
        state.reframe(offset=offset)

    def _shift(self, values: dict[str, float]) -> None:
        """G92 X Y Z: the place of the tool is called so from here on."""
        state = self._state
        builder = self._builder
        self._no_turned_zero(92, values)
        if not set(AXES) & set(values):
            return
        named: list[float | None] = [
            values[letter] * state.unit if letter in values else state.at[index]
            for index, letter in enumerate(AXES)
        ]
        builder.assume("G92: the zero is moved so that the tool's place has these numbers")
        # in turned coordinates each axis moves the zero of others
        straight = np.array_equal(state.tilt[:3, :3], np.eye(3))
        self._shifted |= set(AXES) & set(values) if straight else set(AXES)
        if builder.here is None and not builder.moved:
            state.at = named
            return
        lost = [letter for i, letter in enumerate(AXES) if letter in values and state.at[i] is None]
        if lost:
            raise InputError(f"G92 {lost[0]}, but the tool's place is not known")
        away = self._moved(state.at) - self._moved(named)
        offset = state.offset.copy()
        offset[:3, 3] += away
        state.reframe(offset=offset)
        state.at = named

    def _no_turned_zero(self, code: int, values: dict[str, float]) -> None:
        """G52 A5 and G92 A5 count the angles of A from another zero; nothing changes where G52
        states zero, or G92 the angle that there is.

        Raises:
            InputError: the zero of a rotary axis would be another one.
        """
        rotary = self._state.rotary
        for letter in ROTARY:
            same = 0.0 if code == 52 else rotary[letter]
            if values.get(letter, same) != same:
                raise InputError(
                    f"G{code} {letter}{values[letter]:g} moves the zero of "
                    f"the rotary axis {letter}, which is not read; expected X, Y or Z, and angles "
                    "from the axis's own zero"
                )

    def _moved(self, point: list[float | None]) -> Array:
        state = self._state
        X = state.plane_pose @ state.turned
        return np.asarray(X[:3, :3] @ np.array([p or 0.0 for p in point]) + X[:3, 3])
