"""What moves the tool in APT-like files: points, arcs, splines, holes, and how they are stated."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt import units
from irb2400_ctrl.planners.toolpath.readers.apt.circles import Circles
from irb2400_ctrl.planners.toolpath.readers.apt.cycles import hole_cycle, resumed
from irb2400_ctrl.planners.toolpath.readers.apt.from_the_bottom import (
    FROM_THE_BOTTOM,
    over_the_bottom,
)
from irb2400_ctrl.planners.toolpath.readers.apt.nurbs import Nurbs
from irb2400_ctrl.planners.toolpath.readers.apt.placement import Placement
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, is_number, number
from irb2400_ctrl.planners.toolpath.readers.dialect import CREO
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle
from irb2400_ctrl.planners.toolpath.readers.hole_moves import drill
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.unread_line import WordError


class Motion:
    """Carries statements of motion out on the builder."""

    def __init__(
        self, builder: ProgramBuilder, dialect: str, from_below: Mapping[int, Statement]
    ) -> None:
        self._builder = builder
        self._dialect = dialect
        self._from_below = from_below
        """cycles whose points are the bottoms of their holes, by their line"""
        self._placement = Placement(builder)
        self._circles = Circles(builder, self._placement, dialect)
        self._nurbs = Nurbs(builder, self._placement)
        self._rapid = False
        self._rapid_on = False
        self._cycle: HoleCycle | None = None
        self._last_cycle: Statement | None = None
        self._bottoms = False
        self._last_word = ""
        self._axis_of_before = False
        self._do: dict[str, Callable[[Statement], None]] = {
            "GOTO": self._goto,
            "FROM": self._from,
            "GODLTA": self._delta,
            "GOHOME": self._home,
            "RAPID": self._set_rapid,
            "FEDRAT": self._feed,
            "CIRCLE": self._circles.begin,
            "MOVARC": self._circles.begin,
            "TLON": self._contour,
            "GOFWD": self._contour,
            "INDIRV": self._circles.set_direction,
            "INDIRP": self._circles.set_direction_to,
            "NURBS": self._nurbs.begin,
            "KNOT": self._nurbs.knots,
            "CNTRL": self._nurbs.control,
            "MOVNRB": self._nurbs.creo,
            "CYCLE": self._set_cycle,
            "MODE": self._mode,
            "TLAXIS": self._tool_axis,
            "TRACUT": self._placement.transform,
            "TRANS": self._placement.translate,
        }

    def read(self, statement: Statement, unit: float) -> bool:
        """Carry it out, if it is one of motion; whether it was."""
        word = statement.word
        if word == "" and self._last_word == "GOTO":
            # Creo: further points of an arc on lines of their own
            word = "GOTO"
        if self._nurbs.open and word not in {"KNOT", "CNTRL", "PAINT"}:
            self._nurbs.end(self._take_rapid())
        if word != "GOTO":
            self._circles.interrupted()
        self._last_word = word
        self._axis_of_before = word == "TOOL PATH" or (self._axis_of_before and word != "TLAXIS")
        order = self._do.get(word)
        if order is None:
            return False
        self._placement.unit = unit
        order(statement)
        return True

    def end(self) -> None:
        """The file ends: nothing may be left open."""
        if self._nurbs.open:
            self._nurbs.end(self._take_rapid())
        self._circles.none_open()

    def _goto(self, statement: Statement) -> None:
        builder = self._builder
        position, axis = self._point_and_axis(statement)
        rapid = self._take_rapid()
        if self._cycle is not None:
            if rapid:
                builder.assume("RAPID before a point of a CYCLE/: it is a hole as well")
            drill(builder, self._hole(self._cycle, statement, axis), position, axis)
        elif self._circles.open:
            self._circles.close(position, axis, rapid)
        elif not self._circles.goes_on(position, axis, rapid):
            builder.move(position, axis=axis, rapid=rapid)

    def _point_and_axis(self, statement: Statement) -> tuple[Array, Array | None]:
        """x,y,z or x,y,z,i,j,k of a statement. Creo leaves i,j,k out where the tool stands along z
        (PTC's help, "CL Output for Circular Interpolation"); elsewhere the last one holds."""
        position, axis = self._placement.point_and_axis(statement)
        upright = self._placement.direction([0.0, 0.0, 1.0])
        if axis is None and not np.allclose(upright, self._builder.axis):
            if self._dialect == CREO:
                self._builder.assume("points without i,j,k: the tool stands along z (Creo)")
                axis = upright
            elif self._axis_of_before:
                i, j, k = self._builder.axis
                self._builder.assume(
                    "an operation that begins without i,j,k: the tool stands as at the end of the "
                    f"one before, {i:.4g},{j:.4g},{k:.4g}"
                )
        self._axis_of_before = False
        return position, axis

    def _from(self, statement: Statement) -> None:
        self._circles.none_open()
        position, axis = self._point_and_axis(statement)
        self._builder.start(position, axis)

    def _delta(self, statement: Statement) -> None:
        """GODLTA/dx,dy,dz[,i,j,k], or GODLTA/d along the tool axis."""
        self._circles.none_open()
        builder = self._builder
        values = statement.numbers()
        here = self._placement.here()
        if len(values) not in {1, 3, 6}:
            raise InputError(f"GODLTA/ has {len(values)} numbers, expected 1, 3 or 6")
        axis = self._placement.axis(values[3:]) if len(values) == 6 else None
        if len(values) == 1:
            way = self._placement.unit * values[0] * builder.axis
        else:
            way = self._placement.way(values[:3])
        builder.move(here + way, axis=axis, rapid=self._take_rapid())

    def _home(self, statement: Statement) -> None:
        self._circles.none_open()
        builder = self._builder
        self._rapid = False
        if statement.arguments:
            position, axis = self._point_and_axis(statement)
            builder.move(position, axis=axis, rapid=True)
        else:
            builder.leave()
            builder.assume("GOHOME/ without a place: the machine's home; the robot stays")

    def _contour(self, statement: Statement) -> None:
        if any("/" in argument for argument in statement.arguments):
            self._circles.follow(statement, self._take_rapid())
        elif statement.arguments or statement.word == "GOFWD":
            raise InputError(
                f"{statement.word}/{statement.text[:40]} follows a curve by "
                "its name; expected (CIRCLE/…),ON,(LINE/…), or points"
            )
        else:
            # TLON alone: the tool will be on the line, not beside it
            self._builder.ignore("TLON")

    def _set_cycle(self, statement: Statement) -> None:
        self._circles.none_open()
        builder = self._builder
        word = (statement.words or [""])[0]
        if word in {"OFF", "NOMORE", "INIT"}:
            self._cycle = None
            return
        if word == "ON":
            statement = resumed(self._last_cycle, statement)
        else:
            self._bottoms = statement.line in self._from_below
            statement = self._from_below.get(statement.line, statement)
        if self._bottoms:
            builder.assume(FROM_THE_BOTTOM)
        cycle = hole_cycle(statement, self._placement.unit, self._dialect)
        self._cycle = cycle
        self._last_cycle = statement
        if cycle.assumed:
            builder.assume(f"CYCLE/{cycle.name}: {cycle.assumed}")
        if cycle.clearance == 0:
            builder.assume("CYCLE/ without a clearance: rapid down to the stated point")
        if cycle.name in {"DEEP", "DEEPHL", "PECK", "BRKCHP"} and not cycle.steps:
            builder.assume(f"CYCLE/{cycle.name} without a step: one stroke")

    def _hole(self, cycle: HoleCycle, point: Statement, axis: Array | None) -> HoleCycle:
        """The hole of a point."""
        if not self._bottoms:
            return cycle
        upright = self._placement.direction([0.0, 0.0, 1.0])
        stands = np.allclose(upright, self._builder.axis if axis is None else axis)
        height = self._placement.unit * point.numbers()[2]
        return over_the_bottom(cycle, height, upright=bool(stands))

    def _set_rapid(self, statement: Statement) -> None:
        """RAPID for the next move; RAPID/ON for all until RAPID/OFF."""
        words = set(statement.words)
        self._rapid = "OFF" not in words
        if words <= {"ON", "OFF"}:
            self._rapid_on = "ON" in words or (self._rapid_on and self._rapid)
        else:
            self._builder.assume(
                f"RAPID/{statement.text[:40]}: the speed of the machine's rapid moves is not held"
            )

    def _take_rapid(self) -> bool:
        """Whether this move is rapid: the word holds for one move (ISO 4343)."""
        rapid = self._rapid or self._rapid_on
        self._rapid = False
        return rapid

    def _feed(self, statement: Statement) -> None:
        """A feed; it ends a RAPID before it."""
        builder = self._builder
        words = statement.arguments
        if "INVERS" in words and {"AUTO", "ON", "OFF"} & set(words) and len(words) == 2:
            builder.ignore("FEDRAT/INVERS: how the machine's code is to state the feeds")
            return
        self._rapid = False
        builder.feed = units.feed(statement.arguments, self._placement.unit)

    def _mode(self, statement: Statement) -> None:
        """How the post-processor writes its code; points are absolute in both (Creo, ISO 4343)."""
        if {"INCR", "INC"} & set(statement.words):
            self._builder.assume(
                "MODE/INCR: the code of the machine is to be incremental; the points are absolute"
            )
        else:
            self._builder.ignore(f"MODE/{' '.join(statement.words)}")

    def _tool_axis(self, statement: Statement) -> None:
        values = [number(a, statement.word) for a in statement.arguments if is_number(a)]
        if len(values) != 3:
            raise WordError(statement.word, f"found {len(values)} numbers, expected i,j,k")
        self._builder.axis = self._placement.axis(values)
