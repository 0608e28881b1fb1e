"""Splines in G-code: G5 and G5.1 (LinuxCNC: cubic, quadratic), G6.2 (Fanuc: NURBS)."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.expansion import splines
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder


class GcodeSplines:
    """Carries them out; G6.2 is collected over several blocks."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState) -> None:
        self._builder = builder
        self._state = state
        self._order = 0
        self._knots: list[float] = []
        self._control: list[list[float]] = []
        self._leaving: tuple[float, float] | None = None

    @property
    def open(self) -> bool:
        """Whether a NURBS has begun and lacks knots."""
        return self._order > 0

    def run(self, code: float, values: dict[str, float], axis: Array) -> None:
        """One block of the spline in force.

        Raises:
            InputError: words are missing, or do not fit.
        """
        if code == 6.2:
            self._nurbs(values, axis)
        else:
            self._bezier(code, values, axis)

    def none_open(self) -> None:
        """Another motion begins, or the file ends: nothing may be left open.

        Raises:
            InputError: a NURBS lacks knots.
        """
        if self.open:
            self._order = 0
            raise InputError(
                f"G6.2 ends after {len(self._control)} points and "
                f"{len(self._knots)} knots, expected as many knots as points and order together"
            )
        self._leaving = None

    def _bezier(self, code: float, values: dict[str, float], axis: Array) -> None:
        """G5 X Y I J P Q, where I J may be what the one before left; G5.1 X Y I J."""
        state = self._state
        if state.plane != 17 or "Z" in values:
            raise InputError(f"G{code:g} is a spline in the plane G17, without Z")
        state.placed(state.at)
        start = np.array(state.at, dtype=float)
        target = state.target(values)
        end = np.array(target, dtype=float)
        if code == 5 and "I" not in values and "J" not in values and self._leaving is not None:
            first = self._leaving
        else:
            first = (values.get("I", 0.0), values.get("J", 0.0))
        inner = [start + state.unit * np.array([*first, 0.0])]
        if code == 5:
            if not {"P", "Q"} <= set(values):
                raise InputError("G5 without P and Q, expected X Y I J P Q")
            inner.append(end + state.unit * np.array([values["P"], values["Q"], 0.0]))
            self._leaving = (-values["P"], -values["Q"])
        control = np.array([start, *inner, end])
        degree = len(control) - 1
        knots = np.repeat([0.0, 1.0], degree + 1)
        self._follow(knots, np.column_stack([control, np.ones(degree + 1)]), degree, axis)

    def _nurbs(self, values: dict[str, float], axis: Array) -> None:
        """G6.2 P K X Y Z R, then K X Y Z R, then K alone; the tool is at the first point."""
        state = self._state
        if not self.open:
            self._order = round(values.get("P", 4))
            self._knots = []
            self._control = []
            if not 2 <= self._order <= 10:
                raise InputError(f"G6.2 P{self._order}, expected an order of 2 to 10")
        if "K" not in values:
            raise InputError("a block of G6.2 without K (its knot)")
        self._knots.append(values["K"])
        if any(letter in values for letter in "XYZ"):
            state.placed(state.at)
            state.at = state.target(values)
            weight = values.get("R", 1.0)
            if not weight > 0:
                raise InputError(f"G6.2 R{weight:g}, expected a positive weight")
            p = np.array(state.at, dtype=float)
            self._control.append([*p, weight])
        if len(self._control) < self._order:
            return
        if len(self._knots) == len(self._control) + self._order:
            order = self._order
            self._order = 0
            knots = np.array(self._knots)
            if (np.diff(knots) < 0).any() or knots[order - 1] >= knots[-order]:
                raise InputError("the knots of G6.2 do not rise")
            self._follow(knots, np.array(self._control), order - 1, axis)

    def _follow(self, knots: Array, control: Array, degree: int, axis: Array) -> None:
        """The motion along it, its control points (k, 4) with their weights."""
        state = self._state
        builder = self._builder
        found = splines.rational_points(knots, control, degree, builder.chord)
        X = state.tilt
        places = found @ X[:3, :3].T + X[:3, 3]
        if builder.here is not None and np.linalg.norm(places[0] - builder.here) < 1e-9:
            places = places[1:]
        builder.curve(places, np.tile(axis, (len(places), 1)))
        state.at = list(found[-1])
