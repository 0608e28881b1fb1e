"""Splines in APT-like files: NX `NURBS/`, `KNOT/`, `CNTRL/`; Creo `MOVNRB/`.

NX writes clamped cubics: the tool's place is the first control point, the four knots at zero and
three of the four at the end are left out.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.apt.placement import Placement
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement
from irb2400_ctrl.planners.toolpath.readers.expansion import splines
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder


class Nurbs:
    """The spline in hand."""

    def __init__(self, builder: ProgramBuilder, placement: Placement) -> None:
        self._builder = builder
        self._placement = placement
        self._knots: list[float] | None = None
        self._control: list[list[float]] = []
        self._points_before = -1

    @property
    def open(self) -> bool:
        """Whether a spline has begun."""
        return self._knots is not None

    def begin(self, statement: Statement) -> None:
        """NURBS/"""
        self._knots = []
        self._control = []

    def knots(self, statement: Statement) -> None:
        """KNOT/u,u,…"""
        if self._knots is None:
            raise InputError("KNOT/ without NURBS/ before it")
        self._knots += statement.numbers()

    def control(self, statement: Statement) -> None:
        """CNTRL/x,y,z[,i,j,k]"""
        if self._knots is None:
            raise InputError("CNTRL/ without NURBS/ before it")
        values = statement.numbers()
        if len(values) not in {3, 6} or (self._control and len(values) != len(self._control[0])):
            raise InputError("CNTRL/ expects x,y,z or x,y,z,i,j,k")
        self._control.append(values)

    def end(self, rapid: bool) -> None:
        """The motion along the spline."""
        assert self._knots is not None
        builder = self._builder
        inner = np.array(self._knots)
        self._knots = None
        first = np.concatenate([self._placement.here(), builder.axis])
        rows = []
        for row in self._control:
            axis = self._placement.direction(row[3:]) if len(row) == 6 else np.empty(0)
            rows.append(np.concatenate([self._placement.point(row[:3]), axis]))
        if not rows or not len(inner):
            raise InputError("NURBS/ without KNOT/ and CNTRL/")
        control = np.array([first[: len(rows[0])], *rows])
        knots, control = splines.clamped_cubic(inner, control)
        found = splines.points(knots, control, builder.chord)
        axes = None
        if found.shape[1] == 6:
            length = np.linalg.norm(found[:, 3:], axis=1, keepdims=True)
            if (length < 1e-6).any():
                raise InputError("the tool axis turns over within one spline")
            axes = found[:, 3:] / length
        builder.curve(found[:, :3], axes, rapid=rapid)

    def creo(self, statement: Statement) -> None:
        """PTC: after MOVNRB/NEXT the same motion follows as points, which are taken."""
        word = (statement.words or [""])[0]
        builder = self._builder
        if word == "NEXT":
            self._points_before = builder.points
        elif word == "OFF":
            if self._points_before in {-1, builder.points}:
                raise InputError("MOVNRB/ without points after MOVNRB/NEXT is not read")
            self._points_before = -1
        builder.assume("MOVNRB/: its points (after NEXT) are taken, not the spline")
