"""What moves the tool in G-code: straight moves, arcs and helices."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.expansion.arcs import (
    EXPECTED_MISS,
    Arc,
    largest_miss,
    miss,
    sweep,
)
from irb2400_ctrl.planners.toolpath.readers.gcode.cycles import CYCLES, GcodeCycles
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import REFUSAL, UNCONTROLLED, Rotary
from irb2400_ctrl.planners.toolpath.readers.gcode.siemens_words import TO_ANGLE
from irb2400_ctrl.planners.toolpath.readers.gcode.splines import GcodeSplines
from irb2400_ctrl.planners.toolpath.readers.gcode.state import (
    AXES,
    PLANES,
    ROTARY,
    SPLINES,
    GcodeState,
)
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

CENTRE = "IJK"
# absolute centres: I=AC(10); the tool axis as a vector: A3=0 B3=0 C3=1 (Siemens)
ABSOLUTE = ("IAC", "JAC", "KAC")
VECTOR = ("A3", "B3", "C3")
# an arc by its radius may miss its chord by rounding
RADIUS_SHORT = 1e-5


class GcodeMotion:
    """Carries out the axis words of a block."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState, rotary: Rotary | None) -> None:
        self._builder = builder
        self._state = state
        self._rotary = rotary
        self.splines = GcodeSplines(builder, state)
        self.cycles = GcodeCycles(builder, state)

    def follow(self, on: bool) -> None:
        """G254 and G255 (Haas): the coordinates turn with the rotary axes, or no longer.

        Raises:
            InputError: the axes are turned, and which they are is not stated.
        """
        self._state.follows = on
        if on:
            self._follow()
        else:
            self._state.reframe(plane_pose=np.eye(4))

    def _follow(self) -> None:
        state = self._state
        X = np.eye(4)
        if any(state.rotary.values()):
            if self._rotary is None:
                raise InputError(f"{REFUSAL}")
            X[:3, :3] = self._rotary.rotation(state.rotary)
        state.reframe(plane_pose=X)

    def steer(self, rotary: Rotary | None) -> None:
        """Other rotary axes from here on."""
        self._rotary = rotary

    def run(self, values: dict[str, float]) -> None:
        """The motion in force to the words of a block.

        Raises:
            InputError: a place, centre or axis is not stated or contradicts itself.
        """
        state = self._state
        motion = state.motion
        if why := state.polar_refusal(values):
            raise InputError(f"found {why}")
        if motion is None and None in state.target(values) and not set(values) & set(ROTARY):
            says = "axis words before G0, G1, … are taken as the place of the tool"
            self._builder.assume(says)
            state.at = state.target(values)
            return
        if motion is None:
            raise InputError(
                "found axis words, but no motion is in force; expected G0, "
                "G1, G2, G3 or a cycle before them"
            )
        if motion == 0 and not state.tool_centre and not any(k in values for k in (*AXES, *VECTOR)):
            self._turn_alone(values)
            return
        before = dict(state.rotary)
        axis = self._axis(values)
        if motion not in {0, *CYCLES} and not (self._builder.moved or None in state.at):
            # where the tool is without a move to it: G92, axis words before G0
            self._builder.start(state.placed(state.at), axis)
        if motion in CYCLES:
            self.cycles.run(motion, values)
        elif motion in SPLINES:
            self.splines.run(motion, values, axis)
        elif motion in {2, 3}:
            self._arc(motion, values, axis)
        else:
            self._straight(values, self._way(values, before, axis), rapid=motion == 0)

    def _turn_alone(self, values: dict[str, float]) -> None:
        """G0 with A, B, C only, without tool centre control: the table or the head stands otherwise
        then, and where the tool is in the part is not known."""
        state = self._state
        before = (dict(state.rotary), state.left_turned)
        self._turn(values)
        if (state.rotary, state.left_turned) != before:
            self._builder.assume(
                "G0 with A, B or C alone turns table or head; the robot goes on at the "
                "next stated place"
            )
            self._builder.leave()
            state.at = [None, None, None]

    def _turn(self, values: dict[str, float]) -> None:
        state = self._state
        for letter in ROTARY:
            if letter in values:
                turned_to = state.absolute_of(letter, values)
                turned_to = turned_to or (TO_ANGLE in values and f"{letter}IC" not in values)
                before = 0.0 if turned_to else state.rotary[letter]
                # under tool centre control angles are no way to a plane
                state.turned_by_file = not state.tool_centre
                state.rotary[letter] = before + values[letter]
                state.left_turned = False
        if state.follows and set(ROTARY) & set(values):
            self._follow()

    def _way(self, values: dict[str, float], before: dict[str, float], axis: Array) -> Array:
        """Tool axes of a straight move, shape (m, 3), the last at its end."""
        state = self._state
        R = state.tilt[:3, :3]
        # in a tilted plane (G68.2) the control turns them; DC=, ACP= say which way
        turns = state.tool_centre and np.array_equal(state.plane_pose, np.eye(4))
        turns &= bool(set(ROTARY) & set(values)) and TO_ANGLE not in values
        if self._rotary is None or not (turns and state.evenly):
            return axis[None]
        # a vector or a plane had led the tool elsewhere: how the axes stand is not known
        if not np.allclose(R @ self._rotary.axis(before), self._builder.axis, atol=1e-6):
            return axis[None]
        return np.asarray(self._rotary.way(before, state.rotary) @ R.T)

    def _straight(self, values: dict[str, float], axes: Array, *, rapid: bool) -> None:
        state = self._state
        builder = self._builder
        others = [
            letter for letter in [*"IJKRQ", *ABSOLUTE] if letter in values and not state.vectors
        ]
        if others:
            raise InputError(f"{others[0]} in a straight move is not read")
        target = state.target(values)
        if None in target and state.printers:
            state.at = target
            return
        if None in target and rapid:
            builder.assume(
                "rapid moves before X, Y and Z are all stated are left out: where the tool comes "
                "from is not known"
            )
            state.at = target
            return
        place = state.placed(target)
        if builder.here is None and not rapid:
            builder.assume("the first move comes from an unknown place: begun at its end")
        if builder.here is None or rapid or len(axes) == 1:
            builder.move(place, axis=axes[-1], rapid=rapid, height="Z" in values)
        else:
            share = np.arange(1, len(axes) + 1)[:, None] / len(axes)
            builder.curve(builder.here + share * (place - builder.here), axes)
        state.at = target

    def _arc(self, motion: float, values: dict[str, float], axis: Array) -> None:
        state = self._state
        builder = self._builder
        start = state.at
        state.placed(start)
        target = state.target(values)
        p = np.array(start, dtype=float)
        q = np.array(target, dtype=float)
        first, second, across = PLANES[state.arc_plane(values, p, q)]
        normal = np.zeros(3)
        normal[across] = 1.0 if motion == 3 else -1.0
        by_centre = any(letter in values for letter in (*CENTRE, *ABSOLUTE))
        if by_centre:
            centre = self._centre(values, p, (first, second, across))
        elif "R" in values:
            centre = self._centre_of_radius(p, q, values["R"] * state.unit, normal)
        else:
            raise InputError(
                f"G{motion:g} without a centre; expected {CENTRE[first]}, {CENTRE[second]} or R"
            )
        stated = Arc(centre, normal, None, self._turns(values))
        if by_centre and "R" in values:
            self._same_arc(stated, p, q, values["R"] * state.unit)
        R = state.tilt[:3, :3]
        arc = replace(stated, centre=state.placed(centre), normal=R @ normal)
        builder.arc(arc, state.placed(q), axis=axis)
        state.at = target

    def _same_arc(self, arc: Arc, p: Array, q: Array, radius: float) -> None:
        """I, J, K and R in one block say the same: Fanuc follows R, others I, J, K.

        Args:
            arc: by I, J, K.
            p: its start [m], shape (3,).
            q: its end [m], shape (3,).
            radius: as R states it, negative for more than half a turn [m].

        Raises:
            InputError: another radius than rounding explains, or the other way round the circle.
        """
        allowed = largest_miss(arc, p)
        found = miss(replace(arc, radius=abs(radius)), p, q)
        turned = sweep(replace(arc, turns=1), p, q)
        # R says nothing of a full circle, and its rounding decides what is just half of one
        full = abs(2 * radius * math.sin(turned / 2)) < EXPECTED_MISS
        beside = abs(radius * math.cos(turned / 2))
        half = beside < math.sqrt(2 * abs(radius) * EXPECTED_MISS)
        if found > allowed:
            why = f"their radii differ by {1e3 * found:.4g} mm"
        elif full or half or (turned < math.pi) == (radius > 0):
            return
        else:
            why = f"the one turns by {math.degrees(turned):.0f} deg, the other by the rest"
        raise InputError(
            f"the centre by I, J, K and R ({1e3 * radius:g} mm) of an arc "
            f"differ: {why}; controls follow one or the other, expected one of them"
        )

    def _turns(self, values: dict[str, float]) -> int:
        """P turns (LinuxCNC), or TURN= whole ones besides (Siemens)."""
        turns = values.get("P", values.get("TURN", 0.0) + 1)
        if turns < 1 or turns != int(turns):
            raise InputError(
                f"an arc of {turns:g} turns (P, TURN=), expected a whole number of at least 1"
            )
        return int(turns)

    def _centre(self, values: dict[str, float], p: Array, plane: tuple[int, int, int]) -> Array:
        state = self._state
        first, second, across = plane
        if values.get(CENTRE[across], 0.0) != 0 and not state.arc_absolute:
            raise InputError(
                f"{CENTRE[across]} lies across the plane G{state.plane}; "
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
                        f"absolute centres (G90.1) need {CENTRE[first]} and {CENTRE[second]}"
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
        if length < 1e-9:
            raise InputError("a full turn by R has no centre; expected I, J, K")
        if abs(radius) < length / 2 - RADIUS_SHORT:
            raise InputError(
                f"the radius {1e3 * radius:.4g} mm is less than half the way of "
                f"{1e3 * length:.4g} mm"
            )
        height = math.sqrt(max(radius**2 - (length / 2) ** 2, 0.0))
        side = np.cross(normal, chord / length) * (1.0 if radius > 0 else -1.0)
        return np.asarray(p + chord / 2 + height * side)

    def _axis(self, values: dict[str, float]) -> Array:
        """The tool axis that the block asks for, in the work frame."""
        state = self._state
        builder = self._builder
        self._turn(values)
        R = state.tilt[:3, :3]
        if any(letter in values for letter in VECTOR):
            vector = np.array([values.get(letter, 0.0) for letter in VECTOR])
            length = float(np.linalg.norm(vector))
            if length < 1e-6 or not state.tool_centre:
                raise InputError("A3= B3= C3= without a length, or without TRAORI before them")
            state.vectors = True
            return np.asarray(R @ vector / length)
        if state.vectors and any(letter in values for letter in CENTRE):
            vector = np.array([values.get(letter, 0.0) for letter in CENTRE])
            length = float(np.linalg.norm(vector))
            if abs(length - 1) > 0.02:
                raise InputError(f"the tool axis I J K has length {length:.4g}, expected 1")
            return np.asarray(R @ vector / length)
        # under tool centre control angles are of the machine's axes, which no plane turns
        stated = state.tool_centre and any(letter in values for letter in ROTARY)
        turned = any(state.rotary.values())
        if (stated or turned) and not np.array_equal(state.plane_pose, np.eye(4)):
            # G68.2: the control turns the axes to the tilted plane
            self._agrees(state.plane_pose[:3, 2], stated=stated)
            return np.asarray(R[:, 2])
        if not turned:
            return builder.axis if state.vectors or state.left_turned else np.asarray(R[:, 2])
        if self._rotary is None:
            raise InputError(f"{REFUSAL}")
        if not state.tool_centre:
            raise InputError(f"{UNCONTROLLED}")
        return np.asarray(R @ self._rotary.axis(state.rotary))

    def _agrees(self, normal: Array, *, stated: bool = False) -> None:
        """The angles that the file states lead to the plane that it states.

        Args:
            normal: of the plane, shape (3,).
            stated: in this block, whether or not the control has turned the axes before.

        Raises:
            InputError: the machine's axes are others than `rotary` says.
        """
        state = self._state
        if self._rotary is None and stated:
            raise InputError(f"{REFUSAL}")
        if self._rotary is not None and (state.turned_by_file or stated):
            self._rotary.leads_to(normal, state.rotary)
