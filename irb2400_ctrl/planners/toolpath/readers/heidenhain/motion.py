"""What moves the tool in plain language: L, LN, LP, CC with C and CP, CR, places of the machine."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.feed import Feed
from irb2400_ctrl.planners.toolpath.readers.gcode.codes import RADIUS
from irb2400_ctrl.planners.toolpath.readers.gcode.motion import GcodeMotion
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import Rotary
from irb2400_ctrl.planners.toolpath.readers.gcode.state import AXES, PLANES, ROTARY, GcodeState
from irb2400_ctrl.planners.toolpath.readers.gcode.work_offsets import WorkOffsets
from irb2400_ctrl.planners.toolpath.readers.heidenhain.cycles import PlainCycles
from irb2400_ctrl.planners.toolpath.readers.heidenhain.frames import PlainFrames
from irb2400_ctrl.planners.toolpath.readers.heidenhain.machine import PlainMachine
from irb2400_ctrl.planners.toolpath.readers.heidenhain.words import VECTOR, Words, words_of
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

CENTRES = dict(zip(AXES, ("IAC", "JAC", "KAC"), strict=True))
_POLAR = frozenset(("PR", "PA", "IPR", "IPA"))
# what a block of this kind has not
_ONLY_OTHERS = {
    "CR": _POLAR,
    "CP": frozenset(("R", "PR", "IPR")),
    "LP": frozenset("R"),
    "L": _POLAR | {"R"},
}


class PlainMotion:
    """Carries out blocks with coordinates."""

    def __init__(
        self,
        builder: ProgramBuilder,
        state: GcodeState,
        machine: PlainMachine,
        rotary: Rotary | None,
        frames: Mapping[str, Array],
    ) -> None:
        self._builder = builder
        self._state = state
        self._machine = machine
        self.frames = PlainFrames(builder, state, rotary)
        self.cycles = PlainCycles(builder, state, machine)
        self.motion = GcodeMotion(builder, state, rotary)
        self.offsets = WorkOffsets(builder, state, frames)
        self._pole: dict[str, float] = {}
        self._compensated = ""
        self._turning = 1.0
        self._rapid = True

    def run(self, order: str, code: str) -> None:
        """One block.

        Args:
            order: L, LN, LP, C, CR, CP or CC; empty for a block of M functions alone.
            code: what stands behind it.

        Raises:
            InputError: words that are not read, or contradict each other.
        """
        words = words_of(code)
        if order == "CC":
            self._centre(words)
            return
        self._none_of_others(order, words)
        self._machine.before(words.functions)
        self._speed(words)
        values = self._values(order, words)
        if {91, 92} & set(words.functions):
            self._machine_place(values)
        elif values or words.to_plane:
            self._go(order, words, values)
        if words.retreat is not None:
            self._retreat(words.retreat)
        self.cycles.modal |= 89 in words.functions
        called = 99 in words.functions or (self.cycles.modal and bool(values))
        self.cycles.modal &= 99 not in words.functions
        if called:
            self.drill()
            self._rapid = True
        if 129 in words.functions:
            self.without_centre()
        self._machine.after(words.functions)

    def without_centre(self) -> None:
        """M129, FUNCTION RESET TCPM: head or table stand as TX, TY, TZ had turned them."""
        state = self._state
        if state.vectors and not np.allclose(self._builder.axis, state.tilt[:3, 2]):
            self.frames.turned = False
        state.tool_centre = False
        state.evenly = True
        state.vectors = False

    def call_at(self, code: str) -> None:
        """CYCL CALL POS X Y Z: the cycle at X, Y, with the datum moved by Z along the tool's axis.

        Raises:
            InputError: not all three places, or other axes.
        """
        words = words_of(code)
        values = self._values("L", words)
        if set(AXES) != set(values):
            raise InputError(f"CYCL CALL POS {code[:30]}, expected X, Y and Z")
        self._machine.before(words.functions)
        self._machine.named(apart=True)
        self.offsets.used()
        if values["Z"]:
            self._builder.assume("CYCL CALL POS: Z moves the surface (Q203) of the hole")
        state = self._state
        target = state.target(values)
        state.at = [*target[:2], state.at[2]]
        self.drill(values["Z"] * state.unit)
        self._rapid = True
        self._machine.after(words.functions)

    def drill(self, above: float = 0.0) -> None:
        """The defined cycle where the tool is.

        Args:
            above: how far the surface lies above that of the definition [m].
        """
        self.frames.hold_turned()
        self.cycles.call(above)

    def _speed(self, words: Words) -> None:
        builder = self._builder
        if words.feed == "AUTO":
            if self._machine.tool_feed is None:
                raise InputError("F AUTO without F in TOOL CALL; expected F")
            builder.feed = self._machine.feed(self._machine.tool_feed)
        elif "F" in words.numbers:
            builder.feed = self._machine.feed(words.numbers["F"])
        elif "FU" in words.numbers:
            builder.feed = Feed("turn", words.numbers["FU"] * self._state.unit)
        elif {"FZ", "FT"} & set(words.numbers):
            raise InputError("a feed per tooth or by a time; expected F or FU")
        if words.compensated:
            self._compensated = "" if words.compensated == "R0" else words.compensated

    def _none_of_others(self, order: str, words: Words) -> None:
        """Words that only another kind of block knows.

        Raises:
            InputError: there is one, and no one says where it leads.
        """
        wrong = set(words.numbers) & _ONLY_OTHERS[order if order in _ONLY_OTHERS else "L"]
        if wrong:
            raise InputError(
                f"found {min(wrong)} in a block {order or 'M'}, which it is no word of; "
                "expected PR and PA in LP, PA in CP, R in CR"
            )
        if 130 in words.functions and not np.allclose(self._state.plane_pose, np.eye(4)):
            raise InputError(
                "M130 states a place in the untilted coordinates within a tilted plane; "
                "not read, expected PLANE RESET before it"
            )

    def _values(self, order: str, words: Words) -> dict[str, float]:
        """Places and axes in the words of the G-code reader."""
        values, across = words.tool_axis(order, tool_centre=self._state.tool_centre)
        if across:
            self._builder.assume(across)
        for letter, number in words.numbers.items():
            step = letter.startswith("I")
            axis = letter[1:] if step else letter
            if axis in (*AXES, *ROTARY):
                if axis in values:
                    raise InputError(f"found {axis} and I{axis} in one block")
                values[axis] = number
                if step:
                    values[f"{axis}IC"] = 1.0
            elif axis in "UVW":
                raise InputError(f"found the axis {axis}, which is not read")
        if order in {"CP", "LP"}:
            self._polar(order, words, values)
        return values

    def _go(self, order: str, words: Words, values: dict[str, float]) -> None:
        state = self._state
        builder = self._builder
        turned = set(ROTARY) & set(values)
        if turned or words.to_plane:
            self.frames.turned = True
        if words.to_plane:
            # to the tilted plane, by angles that the control has calculated
            state.turned_by_file = False
            builder.leave()
            state.at = [None, None, None]
        if not values:
            return
        if self._compensated:
            raise InputError(f"{self._compensated} is {RADIUS}; not read")
        if set(VECTOR.values()) & set(values) and not state.tool_centre:
            raise InputError(
                "TX, TY, TZ without M128 or FUNCTION TCPM; expected one of them before it"
            )
        alone = bool(turned) and not set(values) & {*AXES, *VECTOR.values()}
        rapid = words.feed == "MAX" or (alone and not state.tool_centre)
        if not rapid:
            self.frames.hold_turned()
        self._machine.named(apart=self._rapid)
        if order in {"C", "CR", "CP"}:
            if rapid:
                raise InputError("an arc at FMAX, expected a feed")
            self._turning = words.turning or self._turning
            state.motion = 3 if self._turning > 0 else 2
            values |= self._arc(order, words, values)
        else:
            state.motion = 0 if rapid else 1
        if set(values) != turned:
            self.offsets.used()
        self.motion.run(values)
        self._rapid = rapid

    def _arc(self, order: str, words: Words, values: dict[str, float]) -> dict[str, float]:
        """Centre or radius, and turns, in the words of the G-code reader."""
        if order == "CR":
            if "R" not in words.numbers:
                raise InputError("CR without R; expected its radius")
            # a pole in another plane is none of this arc
            named = set(AXES) & set(values)
            across = named == {"Y", "Z"}, named == {"X", "Z"}
            self._state.plane = 19 if across[0] else 18 if across[1] else 17
            return {"R": words.numbers["R"]}
        centre = {CENTRES[axis]: value for axis, value in self._centre_of().items()}
        turns = (abs(words.numbers.get("IPA", 0.0)) - 1e-6) // 360
        return {**centre, "P": max(turns, 0.0) + 1}

    def _centre(self, words: Words) -> None:
        """CC: the pole, in the plane of the two axes that it states."""
        state = self._state
        named = {letter.removeprefix("I") for letter in words.numbers} & set(AXES)
        planes = [plane for plane, (a, b, _) in PLANES.items() if named == {AXES[a], AXES[b]}]
        if planes or not named:
            state.plane = planes[0] if planes else 17
            self._pole = {}
        elif not named < {AXES[i] for i in PLANES[state.plane][:2]}:
            state.plane = 17
        for i in PLANES[state.plane][:2]:
            axis = AXES[i]
            here = state.at[i]
            if axis in words.numbers:
                self._pole[axis] = words.numbers[axis]
            elif f"I{axis}" in words.numbers or axis not in self._pole:
                if here is None:
                    raise InputError(f"CC from where the tool is, and its {axis} is not stated yet")
                self._pole[axis] = here / state.unit + words.numbers.get(f"I{axis}", 0.0)

    def _centre_of(self) -> dict[str, float]:
        if not self._pole:
            raise InputError("an arc without its centre; expected CC")
        return self._pole

    def _polar(self, order: str, words: Words, values: dict[str, float]) -> None:
        """PR and PA about the pole, as places of the plane's axes in `values`."""
        state = self._state
        pole = self._centre_of()
        first, second, _ = PLANES[state.plane]
        from_pole = [
            None if (at := state.at[i]) is None else at / state.unit - pole[AXES[i]]
            for i in (first, second)
        ]
        u, v = from_pole
        stated = words.numbers
        step = stated.get("IPA")
        known = u is not None and v is not None
        stated_alone = order == "LP" and {"PR", "PA"} <= set(stated)
        if not (known or stated_alone):
            raise InputError("a polar step from a place that is not stated")
        radius = math.hypot(u or 0.0, v or 0.0)
        angle = math.degrees(math.atan2(v or 0.0, u or 0.0))
        if order == "LP":
            radius = stated.get("PR", radius + stated.get("IPR", 0.0))
        angle = stated.get("PA", angle + (step or 0.0))
        if step is not None and order == "CP":
            if words.turning and words.turning * step < 0:
                raise InputError(
                    f"IPA{step:+g} and DR{'+' if words.turning > 0 else '-'}"
                    " turn against each other; expected the same sign"
                )
            self._turning = math.copysign(1.0, step)
        turn = math.radians(angle)
        values[AXES[first]] = pole[AXES[first]] + radius * math.cos(turn)
        values[AXES[second]] = pole[AXES[second]] + radius * math.sin(turn)

    def _machine_place(self, values: dict[str, float]) -> None:
        """M91, M92: a place of the machine tool."""
        state = self._state
        self._builder.assume("M91, M92: places of the machine tool; the robot does not go there")
        self._builder.leave()
        state.lose({axis for axis in AXES if axis in values})
        for axis in set(ROTARY) & set(values):
            state.rotary[axis] = values[axis]
            self.frames.turned = True
        self._rapid = True

    def _retreat(self, way: float) -> None:
        """M140 MB: away from the part along the tool axis."""
        state = self._state
        if math.isfinite(way) and None not in state.at and not state.tool_centre:
            state.motion = 0
            self.motion.run({"Z": way, "ZIC": 1.0})
        else:
            self._builder.assume("M140 MB MAX: up to the machine's limit; left out")
            self._builder.leave()
            state.at = [None, None, None] if state.tool_centre else [*state.at[:2], None]
        self._rapid = True
