"""What moves the tool in G-code: straight moves, arcs, helices and canned cycles."""

from __future__ import annotations

import math

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.expansion.arcs import Arc
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import REFUSAL, Rotary
from irb2400_ctrl.planners.toolpath.readers.gcode.splines import MODES, GcodeSplines
from irb2400_ctrl.planners.toolpath.readers.gcode.state import AXES, PLANES, ROTARY, GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

CENTRE = "IJK"
# absolute centres: I=AC(10); the tool axis as a vector: A3=0 B3=0 C3=1 (Siemens)
ABSOLUTE = ("IAC", "JAC", "KAC")
VECTOR = ("A3", "B3", "C3")
DWELLING = frozenset([76, 82, 88, 89])
CYCLES = {
    73: "chip",
    74: "bore",
    76: "drill",
    81: "drill",
    82: "drill",
    83: "peck",
    84: "bore",
    85: "bore",
    86: "drill",
    88: "bore",
    89: "bore",
}
# an arc by its radius may miss its chord by rounding
RADIUS_SHORT = 1e-5
MOST_REPEATS = 10_000


class GcodeMotion:
    """Carries out the axis words of a block."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState, rotary: Rotary | None) -> None:
        self._builder = builder
        self._state = state
        self._rotary = rotary
        self.splines = GcodeSplines(builder, state)

    def run(self, values: dict[str, float]) -> None:
        """The motion in force to the words of a block.

        Raises:
            InputError: a place, centre or axis is not stated or contradicts itself.
        """
        state = self._state
        motion = state.motion
        if motion is None:
            raise InputError(
                f"{self._builder.place}: found axis words, but no motion is in force; expected G0, "
                "G1, G2, G3 or a cycle before them"
            )
        axis = self._axis(values)
        if motion in CYCLES:
            self._cycle(motion, values)
        elif motion in MODES:
            self.splines.run(motion, values, axis)
        elif motion in {2, 3}:
            self._arc(motion, values, axis)
        else:
            self._straight(values, axis, rapid=motion == 0)

    def _straight(self, values: dict[str, float], axis: Array, *, rapid: bool) -> None:
        state = self._state
        builder = self._builder
        others = [
            letter for letter in [*"IJKRQ", *ABSOLUTE] if letter in values and not state.vectors
        ]
        if others:
            raise InputError(f"{builder.place}: {others[0]} in a straight move is not read")
        target = state.target(values)
        if None in target and rapid:
            builder.note(
                "assumed",
                "rapid moves before X, Y and Z are all stated are left out: where the tool comes "
                "from is not known",
            )
            state.at = target
            return
        place = state.placed(target, builder.place)
        if builder.here is None and not rapid:
            builder.note("assumed", "the first move comes from an unknown place: begun at its end")
        builder.move(place, axis=axis, rapid=rapid)
        state.at = target

    def _arc(self, motion: float, values: dict[str, float], axis: Array) -> None:
        state = self._state
        builder = self._builder
        start = state.at
        state.placed(start, builder.place)
        target = state.target(values)
        first, second, across = PLANES[state.plane]
        p = np.array(start, dtype=float)
        q = np.array(target, dtype=float)
        normal = np.zeros(3)
        normal[across] = 1.0 if motion == 3 else -1.0
        if any(letter in values for letter in (*CENTRE, *ABSOLUTE)):
            centre = self._centre(values, p, (first, second, across))
        elif "R" in values:
            centre = self._centre_of_radius(p, q, values["R"] * state.unit, normal)
        else:
            raise InputError(
                f"{builder.place}: G{motion:g} without a centre; expected "
                f"{CENTRE[first]}, {CENTRE[second]} or R"
            )
        R = state.tilt[:3, :3]
        arc = Arc(
            state.placed(centre, builder.place),
            R @ normal,
            None,
            max(round(self._turns(values)), 1),
        )
        builder.arc(arc, state.placed(q, builder.place), axis=axis)
        state.at = target

    @staticmethod
    def _turns(values: dict[str, float]) -> float:
        """P turns (LinuxCNC), or TURN= whole ones besides (Siemens)."""
        return values.get("P", values.get("TURN", 0.0) + 1)

    def _centre(self, values: dict[str, float], p: Array, plane: tuple[int, int, int]) -> Array:
        state = self._state
        first, second, across = plane
        if values.get(CENTRE[across], 0.0) != 0 and not state.arc_absolute:
            raise InputError(
                f"{self._builder.place}: {CENTRE[across]} lies across the plane G{state.plane}; "
                f"expected {CENTRE[first]} and {CENTRE[second]}"
            )
        centre = p.copy()
        for index in (first, second):
            letter = CENTRE[index]
            if ABSOLUTE[index] in values:
                centre[index] = values[ABSOLUTE[index]] * state.unit
            elif state.arc_absolute:
                if letter not in values:
                    raise InputError(
                        f"{self._builder.place}: absolute centres (G90.1) need {CENTRE[first]} and "
                        f"{CENTRE[second]}"
                    )
                centre[index] = values[letter] * state.unit
            else:
                centre[index] += values.get(letter, 0.0) * state.unit
        return centre

    def _centre_of_radius(self, p: Array, q: Array, radius: float, normal: Array) -> Array:
        """Left of the chord for less than half a turn; a negative radius asks for more."""
        chord = q - p
        chord = chord - (chord @ normal) * normal
        length = float(np.linalg.norm(chord))
        place = self._builder.place
        if length < 1e-9:
            raise InputError(f"{place}: a full turn by R has no centre; expected I, J, K")
        if abs(radius) < length / 2 - RADIUS_SHORT:
            raise InputError(
                f"{place}: the radius {1e3 * radius:.4g} mm is less than half the way of "
                f"{1e3 * length:.4g} mm"
            )
        height = math.sqrt(max(radius**2 - (length / 2) ** 2, 0.0))
        side = np.cross(normal, chord / length) * (1.0 if radius > 0 else -1.0)
        return np.asarray(p + chord / 2 + height * side)

    def _cycle(self, motion: float, values: dict[str, float]) -> None:
        state = self._state
        builder = self._builder
        place = builder.place
        if state.plane != 17:
            raise InputError(f"{place}: G{motion:g} in the plane G{state.plane}, expected G17")
        if motion == 76:
            if set("IJK") <= set(values):
                raise InputError(f"{place}: G76 with I, J and K cuts a thread; not read")
            builder.note("assumed", "G76: straight out of the hole, without its way aside (Q)")
        if motion == 88:
            builder.note(
                "assumed", "G88: out of the hole at feed, without waiting for the operator"
            )
        self._store(values)
        words = state.cycle
        missing = [letter for letter in "ZR" if letter not in words]
        if missing or (motion in {73, 83} and words.get("Q", 0.0) <= 0):
            raise InputError(
                f"{place}: G{motion:g} without {(missing or ['a positive Q'])[0]}; expected X, Y, "
                "Z, R" + (", Q" if motion in {73, 83} else "")
            )
        repeats = round(values.get("L", values.get("K", 1.0)))
        if not 0 <= repeats <= MOST_REPEATS:
            raise InputError(f"{place}: a cycle repeated {repeats} times, expected 0 … 10,000")
        level, bottom = self._heights(motion)
        for _ in range(repeats):
            self._one_hole(motion, values, level, bottom)

    def _heights(self, motion: float) -> tuple[float, float]:
        """R and Z of the hole; in G91 R counts from where the tool is, Z from R. Repeats keep
        them."""
        state = self._state
        words = state.cycle
        old = state.at[2]
        level = words["R"]
        bottom = words["Z"]
        if not state.absolute:
            if old is None:
                raise InputError(
                    f"{self._builder.place}: a cycle in G91 from a Z that is not stated yet"
                )
            level = old + words["R"]
            bottom = level + words["Z"]
        if bottom > level + 1e-9:
            raise InputError(
                f"{self._builder.place}: G{motion:g}: Z is above R ({1e3 * bottom:.4g} over "
                f"{1e3 * level:.4g} mm), expected the bottom below"
            )
        return level, bottom

    def _store(self, values: dict[str, float]) -> None:
        """Z, R, Q and P stay for the next blocks."""
        state = self._state
        for letter in "ZRQP":
            if letter in values:
                state.cycle[letter] = values[letter] * (1.0 if letter == "P" else state.unit)

    def _one_hole(
        self, motion: float, values: dict[str, float], level: float, bottom: float
    ) -> None:
        state = self._state
        builder = self._builder
        words = state.cycle
        across = {key: value for key, value in values.items() if key in "XY"}
        x, y, old = state.target(across)
        point = state.placed([x, y, level], builder.place)
        cycle = HoleCycle(
            CYCLES[int(motion)],
            max(level - bottom, 0.0),
            0.0,
            math.inf if state.retract_to_start else 0.0,
            (words["Q"],) if motion in {73, 83} else (),
            dwell_seconds(words.get("P", 0.0)) if motion in DWELLING else 0.0,
            None,
            f"G{motion:g}",
        )
        z = state.tilt[:3, 2]
        if not np.allclose(z, builder.axis, atol=1e-6) and builder.moved:
            raise InputError(f"{builder.place}: a cycle with the tool not along its Z")
        builder.drill(cycle, point, z)
        end = level if not state.retract_to_start or old is None else max(level, old)
        state.at = [x, y, end]

    def _axis(self, values: dict[str, float]) -> Array:
        """The tool axis that the block asks for, in the work frame."""
        state = self._state
        builder = self._builder
        for letter in ROTARY:
            if letter in values:
                before = 0.0 if state.absolute else state.rotary[letter]
                state.rotary[letter] = before + values[letter]
        R = state.tilt[:3, :3]
        if any(letter in values for letter in VECTOR):
            vector = np.array([values.get(letter, 0.0) for letter in VECTOR])
            length = float(np.linalg.norm(vector))
            if length < 1e-6 or not state.tool_centre:
                raise InputError(
                    f"{builder.place}: A3= B3= C3= without a length, or without TRAORI before them"
                )
            state.vectors = True
            return np.asarray(R @ vector / length)
        if state.vectors and any(letter in values for letter in CENTRE):
            vector = np.array([values.get(letter, 0.0) for letter in CENTRE])
            length = float(np.linalg.norm(vector))
            if abs(length - 1) > 0.02:
                raise InputError(
                    f"{builder.place}: the tool axis I J K has length {length:.4g}, expected 1"
                )
            return np.asarray(R @ vector / length)
        if not any(state.rotary.values()):
            return builder.axis if state.vectors else np.asarray(R[:, 2])
        if self._rotary is None or not state.tool_centre:
            raise InputError(f"{builder.place}: {REFUSAL}")
        try:
            return np.asarray(R @ self._rotary.axis(state.rotary))
        except InputError as error:
            raise InputError(f"{builder.place}: {error}") from error


def dwell_seconds(stated: float) -> float:
    """A dwell [s]: milliseconds (Fanuc) where the number is 100 or more, else seconds."""
    return stated / 1000 if stated >= 100 else stated


def moves(values: dict[str, float], motion: float | None = None) -> bool:
    """Whether a block has words that lead somewhere; a full circle needs its centre only."""
    curved = motion in {2, 3, *MODES}
    words = (*AXES, *ROTARY, *VECTOR, *(CENTRE if curved else ()))
    return any(letter in values for letter in words)
