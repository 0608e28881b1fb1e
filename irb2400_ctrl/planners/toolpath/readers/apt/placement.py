"""How numbers of an APT-like file become places: unit, `TRACUT/`, `TRANS/`, the tool's place."""

from __future__ import annotations

import math

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt import frames
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, number
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.unread_line import WordError

AXIS_ERROR = 0.02


class Placement:
    """The unit and the transformation in force."""

    def __init__(self, builder: ProgramBuilder) -> None:
        self._builder = builder
        self.unit = 1e-3
        """[m]"""
        self.shift = np.eye(4)
        """what `TRACUT/` and `TRANS/` do to the points that follow"""

    def point(self, values: list[float]) -> Array:
        """A place in the file's unit, in metres and moved."""
        X = self.shift
        return np.asarray(X[:3, :3] @ (self.unit * np.array(values)) + X[:3, 3])

    def way(self, values: list[float]) -> Array:
        """A difference of places."""
        return np.asarray(self.shift[:3, :3] @ (self.unit * np.array(values)))

    def direction(self, values: list[float]) -> Array:
        """A direction, as long as stated."""
        return np.asarray(self.shift[:3, :3] @ np.array(values))

    def axis(self, values: list[float]) -> Array:
        """A tool axis; InputError where its length is not one."""
        length = math.hypot(*values)
        if abs(length - 1) > AXIS_ERROR:
            raise InputError(f"the tool axis {values} has length {length:.4g}, expected 1")
        return self.direction([value / length for value in values])

    def point_and_axis(self, statement: Statement) -> tuple[Array, Array | None]:
        """x,y,z or x,y,z,i,j,k of a statement."""
        word = statement.word or "GOTO"
        values = [number(a, word) for a in statement.arguments]
        if len(values) not in {3, 6}:
            raise InputError(f"{word}/ has {len(values)} numbers, expected x,y,z or x,y,z,i,j,k")
        return self.point(values[:3]), self.axis(values[3:]) if len(values) == 6 else None

    def here(self) -> Array:
        """Where the tool is; InputError where that is not stated yet."""
        if self._builder.here is None:
            raise InputError(
                "a way from a place that is not known; expected FROM/ or GOTO/ before it"
            )
        return self._builder.here

    def transform(self, statement: Statement) -> None:
        """TRACUT/matrix, TRACUT/NOMORE."""
        if set(statement.words) & {"NOMORE", "OFF"}:
            self.shift = np.eye(4)
            return
        builder = self._builder
        values = [number(a, statement.word) for a in statement.arguments if a.upper() != "LAST"]
        try:
            self.shift = frames.of_rows(values, self.unit)
        except InputError as error:
            raise WordError(statement.word, str(error)) from error
        builder.assume("TRACUT/: the points after it are moved by its matrix")

    def translate(self, statement: Statement) -> None:
        """TRANS/x,y,z, TRANS/NOMORE."""
        builder = self._builder
        if set(statement.words) & {"NOMORE", "OFF"}:
            self.shift = np.eye(4)
            return
        values = statement.numbers()
        if len(values) != 3:
            raise InputError(f"TRANS/ has {len(values)} numbers, expected x,y,z")
        self.shift = self.shift.copy()
        self.shift[:3, 3] = self.unit * np.array(values)
        builder.assume("TRANS/: the points after it are moved by it")
