"""Arcs in APT-like files: `CIRCLE/`, `MOVARC/` with the `GOTO/` that ends them, `TLON,GOFWD/`."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt import contour
from irb2400_ctrl.planners.toolpath.readers.apt.placement import Placement
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, is_number, number
from irb2400_ctrl.planners.toolpath.readers.dialect import CREO, NX
from irb2400_ctrl.planners.toolpath.readers.expansion import arcs
from irb2400_ctrl.planners.toolpath.readers.expansion.arcs import Arc
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.unread_line import UnreadLineError

WORDS = frozenset({"TIMES", "ANGLE", "CENTER", "AXIS", "RADIUS", "CANON"})
# Creo writes ten digits: a further point of an arc lies this close to its circle
ON_CIRCLE = 2e-6
# a full circle closes to the digits of the file: four of mm, five of inches
CLOSES = 3e-7
ANGLE_ERROR = math.radians(0.5)


class Circles:
    """The arc that waits for its end, and the direction that `INDIRV/` states."""

    def __init__(self, builder: ProgramBuilder, placement: Placement, dialect: str) -> None:
        self._builder = builder
        self._placement = placement
        self._dialect = dialect
        self._arc: Arc | None = None
        self._angle: float | None = None
        self._line = 0
        self._more: Arc | None = None
        self._swept = 0.0
        """by the points so far of the arc that may go on [rad]"""
        self._first = 0.0
        """by the first of them [rad]"""
        self._shorter = False
        """no axis is stated: the arc goes the shorter way about z"""
        self._direction: Array | None = None

    @property
    def open(self) -> bool:
        """Whether an arc waits for its end."""
        return self._arc is not None

    def begin(self, statement: Statement) -> None:
        """CIRCLE/ or MOVARC/ x,y,z,i,j,k[,r][,…][,TIMES,n][,ANGLE,a]; the next GOTO/ ends it."""
        self.none_open()
        values, times, angle = _values(statement)
        self._shorter = len(values) == 4
        if self._shorter:
            values = [*values[:3], 0.0, 0.0, 1.0, values[3]]
        wrong = len(values) < 6 or (len(values) > 6 and values[6] <= 0)
        if wrong or math.hypot(*values[3:6]) < 1e-6:
            raise InputError(
                f"{statement.word}/ has the numbers {values}, expected x,y,z,i,j,k,radius"
            )
        # NX: "axis vector … (assuming a clockwise direction)"; PTC: the right-hand rule
        sign = -1.0 if self._dialect == NX else 1.0
        normal = sign * self._placement.direction(values[3:6])
        radius = self._placement.unit * values[6] if len(values) > 6 else None
        self._arc = Arc(self._placement.point(values[:3]), normal, radius, times, CLOSES)
        self._angle = angle
        self._line = statement.line
        if times > 1:
            self._builder.assume("TIMES,n: the arc ends in its n-th turn")
        if self._shorter:
            self._builder.assume(
                f"{statement.word}/ without i,j,k: the shorter way to the next point"
            )
        elif self._dialect not in {NX, CREO} and statement.word == "CIRCLE":
            self._builder.assume("CIRCLE/ turns right-handed about its axis")

    def close(self, position: Array, axis: Array | None, rapid: bool) -> None:
        """The end of the arc."""
        assert self._arc is not None
        arc = self._arc
        self._arc = None
        if self._angle is not None:
            arc = self._fitting(arc, position, self._angle)
        self._swept = arcs.sweep(arc, self._placement.here(), position)
        if self._shorter and self._angle is None and self._swept > math.pi + ANGLE_ERROR:
            arc = replace(arc, normal=-arc.normal)
            self._swept = arcs.sweep(arc, self._placement.here(), position)
        self._first = self._swept
        self._builder.arc(arc, position, axis=axis, rapid=rapid)
        self._more = arc if self._dialect == CREO else None

    def goes_on(self, position: Array, axis: Array | None, rapid: bool) -> bool:
        """Creo: further points of the same arc; whether this one was."""
        if self._more is None or not self._on_circle(self._more, position):
            self._more = None
            return False
        self._swept += arcs.sweep(self._more, self._placement.here(), position)
        if self._swept > 2 * math.pi + ANGLE_ERROR:
            self._more = None
            if self._first < math.pi:
                return False
            raise InputError(
                f"the points of the arc of line {self._line} go round more "
                "than once about its i,j,k by the right-hand rule; expected them in the order in "
                "which they are passed, or i,j,k the other way"
            )
        self._builder.arc(self._more, position, axis=axis, rapid=rapid)
        return True

    def interrupted(self) -> None:
        """Another statement than GOTO/: no further points of an arc follow."""
        self._more = None

    def none_open(self) -> None:
        """InputError where an arc still waits for its end."""
        if self._arc is not None:
            self._arc = None
            raise UnreadLineError(
                self._line, "CIRCLE/ is not read: no GOTO/ with the end of the arc follows it"
            )

    def set_direction(self, statement: Statement) -> None:
        """INDIRV/i,j,k."""
        values = statement.numbers()
        if len(values) != 3:
            raise InputError("INDIRV/ expects three numbers")
        self._direction = np.array(values)

    def set_direction_to(self, statement: Statement) -> None:
        """INDIRP/x,y,z: towards this point."""
        values = statement.numbers()
        if len(values) != 3:
            raise InputError("INDIRP/ expects three numbers")
        self._direction = self._placement.point(values) - self._placement.here()

    def follow(self, statement: Statement, rapid: bool) -> None:
        """TLON,GOFWD/…"""
        builder = self._builder
        self.none_open()
        if not np.array_equal(self._placement.shift, np.eye(4)):
            raise InputError("TLON/ together with TRACUT/ or TRANS/ is not read")
        arc, end = contour.arc_and_end(
            statement, self._placement.here(), self._direction, self._placement.unit
        )
        self._direction = None
        builder.arc(arc, end, rapid=rapid)

    def _fitting(self, arc: Arc, end: Array, degrees: float) -> Arc:
        """The arc in the direction that turns by the stated angle."""
        angle = math.radians(abs(degrees))
        for normal in (arc.normal, -arc.normal):
            turned = replace(arc, normal=normal)
            once = arcs.sweep(replace(turned, turns=1), self._placement.here(), end)
            off = (angle - once + math.pi) % (2 * math.pi) - math.pi
            if abs(off) < ANGLE_ERROR:
                turns = max(round((angle - once) / (2 * math.pi)), 0) + 1
                return replace(turned, turns=turns)
        raise InputError(
            f"the arc of line {self._line} turns by {degrees:g} deg, but "
            "the next point lies elsewhere"
        )

    def _on_circle(self, arc: Arc, position: Array) -> bool:
        here = self._placement.here()
        level = float((position - here) @ arc.normal) / float(np.linalg.norm(arc.normal))
        return (
            arcs.miss(arc, here, position) < ON_CIRCLE
            and abs(level) < ON_CIRCLE
            and float(np.linalg.norm(position - here)) > ON_CIRCLE
        )


def _values(statement: Statement) -> tuple[list[float], int, float | None]:
    """Numbers before TIMES and ANGLE, and theirs."""
    values: list[float] = []
    times = 1
    angle = None
    last = ""
    for argument in statement.arguments:
        if not is_number(argument):
            last = argument.upper()
            if last not in WORDS:
                raise InputError(f"{statement.word}/ has the word {last}, expected numbers")
            continue
        value = number(argument, statement.word)
        if last == "TIMES":
            times = max(round(value), 1)
        elif last == "ANGLE":
            angle = value
        else:
            values.append(value)
    return values, times, angle
