"""Canned cycles of G-code (G73 … G89), and holes as calls (Siemens)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle
from irb2400_ctrl.planners.toolpath.readers.gcode.blocks import Block
from irb2400_ctrl.planners.toolpath.readers.gcode.hole_calls import HoleCall, cycle_of, left_out
from irb2400_ctrl.planners.toolpath.readers.gcode.hole_patterns import PATTERNS, places
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.hole_moves import drill
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

DWELLING = frozenset([76, 82, 86, 88, 89])
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
# words besides: the way aside of fine boring, how fast the tap turns back (Haas)
_AND_MORE = {**dict.fromkeys(map(float, CYCLES), ""), 76: "IJ", 74: "J", 84: "J"}
MOST_REPEATS = 10_000
LONGEST_IN_A_HOLE = 10.0
"""P of a cycle from here on is none in seconds"""
NOT_CARRIED_OUT = {
    "CYCLE84": "the spindle is not turned the other way for the way out",
    "CYCLE86": "straight out of the hole; the spindle is not stopped and turned to POSS, and the "
    "way aside (RPA, RPO, RPAP) is not gone",
}
"""what the robot does otherwise than the control"""


class GcodeCycles:
    """Carries them out."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState) -> None:
        self._builder = builder
        self._state = state
        self._modal: HoleCall | None = None
        self._okuma = False
        self._level: float | None = None
        """of G71 (Okuma), over the zero [m]"""
        self._to_level = False
        """M53: to that level after each hole"""

    def survey(self, listed: Iterable[Block]) -> None:
        """Before the first block: in a file with M53 beside cycles, G71 Z is the level that it goes
        back to (Okuma)."""
        self._okuma = any(
            53 in block.codes("M") and CYCLES.keys() & set(block.codes("G")) for block in listed
        )

    def return_level(self, codes: list[float], values: dict[str, float]) -> bool:
        """Whether a block states the level of M53, which is kept: it moves nothing then.

        Raises:
            InputError: stated in G91.
        """
        if not (self._okuma and codes == [71] and set(values) == {"Z"}):
            return False
        if not self._state.absolute:
            raise InputError("G71 Z (Okuma) in G91, expected G90: the level is a height")
        self._level = values["Z"] * self._state.unit
        return True

    def returns(self, functions: list[int]) -> list[int]:
        """M53: each hole ends at the level of G71; M54: at R; M52: at the top of the machine. The
        other functions.

        Raises:
            InputError: M52, or M53 without a level.
        """
        if not self._okuma or not {52, 53, 54} & set(functions):
            return functions
        if 52 in functions:
            raise InputError(
                "M52 (Okuma) goes to the top of the machine after each hole, which the robot has "
                "not; expected M53 with a height (G71 Z)"
            )
        self._to_level = 53 in functions
        self._state.retract_to_start = False
        if self._to_level and self._level is None:
            raise InputError(
                "M53 (Okuma) goes back to the level of G71 after each hole, and none is stated "
                "before it; expected a line G71 Z…"
            )
        return [function for function in functions if function not in {53, 54}]

    def run(self, motion: float, values: dict[str, float]) -> None:
        """Holes at the places that a block states.

        Raises:
            InputError: words are missing or contradict each other.
        """
        state = self._state
        builder = self._builder
        if state.plane != 17:
            raise InputError(f"G{motion:g} in the plane G{state.plane}, expected G17")
        if state.feed_mode == 93:
            raise InputError(
                f"G{motion:g} in inverse time (G93), which states the time of one move; "
                "expected G94 or G95 before the cycle"
            )
        self._refuse_other_words(motion, values)
        if "ZIC" in values or "ZAC" in values:
            raise InputError("Z=IC(…) or Z=AC(…) in a cycle is not read; expected Z")
        if motion == 76:
            if set("IJK") <= set(values):
                raise InputError("G76 with I, J and K cuts a thread; not read")
            builder.assume("G76: straight out of the hole, without its way aside (Q)")
        if motion == 88:
            builder.assume("G88: out of the hole at feed, without waiting for the operator")
        self._store(values)
        words = state.cycle
        missing = [letter for letter in "ZR" if letter not in words]
        if missing or (motion in {73, 83} and words.get("Q", 0.0) <= 0):
            raise InputError(
                f"G{motion:g} without {(missing or ['a positive Q'])[0]}; expected X, Y, "
                "Z, R" + (", Q" if motion in {73, 83} else "")
            )
        repeats = self._repeats(motion, values)
        if words["Z"] > words["R"] + 1e-9:
            raise InputError(
                f"G{motion:g}: Z is above R ({1e3 * words['Z']:.4g} over "
                f"{1e3 * words['R']:.4g} mm), expected the bottom below"
            )
        for _ in range(repeats):
            self._one_hole(motion, values)

    def _refuse_other_words(self, motion: float, values: dict[str, float]) -> None:
        """I and J shape the steps of a deep hole on some controls.

        Raises:
            InputError: there is one that no one carries out.
        """
        idle = [letter for letter in "IJD" if letter in values and letter not in _AND_MORE[motion]]
        if idle:
            raise InputError(
                f"found {idle[0]}{values[idle[0]]:g} in the cycle G{motion:g}, where it is not "
                "read (steps that become smaller on controls of Haas, others elsewhere); expected "
                "X, Y, Z, R, P, Q, F, or moves that the CAM system has written out"
            )

    def _repeats(self, motion: float, values: dict[str, float]) -> int:
        """L or K: how many holes a block makes, one where neither is stated.

        Raises:
            InputError: not a whole number of 0 to 10,000, or two different ones.
        """
        builder = self._builder
        stated = [letter for letter in "LK" if letter in values]
        if not stated:
            return 1
        letter = stated[0]
        count = values[letter]
        if count != values[stated[-1]]:
            raise InputError(
                f"found L{count:g} and K{values['K']:g} in a cycle, and both say "
                "how often; expected one of them"
            )
        if not (0 <= count <= MOST_REPEATS and count == int(count)):
            raise InputError(
                f"G{motion:g} with {letter}{count:g}: {letter} says how often the "
                "hole is repeated, expected a whole number from 0 to 10,000; where it is a length "
                "of the cycle (some controls), leave it out or let the CAM system write for Fanuc "
                "or LinuxCNC"
            )
        if count == 0:
            builder.assume(
                f"{letter}0 in a cycle: its words are kept for the next blocks, and no hole is "
                "drilled here (Fanuc)"
            )
        elif count > 1 and self._state.absolute:
            builder.assume(
                f"G{motion:g} with {letter}{count:g} in G90: the same hole {count:g} times; on "
                f"some controls {letter} is a length of the cycle"
            )
        return int(count)

    def _store(self, values: dict[str, float]) -> None:
        """Z, R, Q and P stay for the next blocks: Z and R as heights, whichever way they were
        stated. In G91 R counts from where the tool was as the cycle began, Z from R."""
        state = self._state
        cycle = state.cycle
        if not cycle and state.at[2] is not None:
            cycle["start"] = state.at[2]
        stated = {letter: values[letter] * state.unit for letter in "RZQ" if letter in values}
        if not state.absolute and {"R", "Z"} & set(stated):
            if "start" not in cycle:
                raise InputError("a cycle in G91 from a Z that is not stated yet")
            if "R" in stated:
                stated["R"] += cycle["start"]
            if "Z" in stated:
                stated["Z"] += stated.get("R", cycle.get("R", 0.0))
        elif "R" in cycle and not {"R", "Z"} & set(stated) and cycle["G90"] != state.absolute:
            self._builder.assume(
                "G90 or G91 within a cycle: Z and R stay the heights they were (Fanuc)"
            )
        if {"R", "Z"} & set(stated):
            cycle["G90"] = state.absolute
        cycle.update(stated)
        if "P" in values:
            cycle["P"] = values["P"]

    def _one_hole(self, motion: float, values: dict[str, float]) -> None:
        state = self._state
        words = state.cycle
        level = words["R"]
        across = {key: value for key, value in values.items() if key[0] in "XY"}
        x, y, _ = state.target(across)
        # G98: to where the tool was as the cycle began, also after holes with G99
        up = max(words.get("start", level) - level, 0.0) if state.retract_to_start else 0.0
        if self._to_level and self._level is not None:
            up = max(self._level - level, 0.0)
        cycle = HoleCycle(
            CYCLES[int(motion)],
            max(level - words["Z"], 0.0),
            0.0,
            up,
            (words["Q"],) if motion in {73, 83} else (),
            self._dwell(words.get("P", 0.0)) if motion in DWELLING else 0.0,
            None,
            f"G{motion:g}",
        )
        drill_along_z(self._builder, state, cycle, (x, y, level))

    def _dwell(self, stated: float) -> float:
        """P of a cycle as a time [s]: nobody turns a drill in a hole for ten seconds."""
        seconds = dwell_seconds(stated, LONGEST_IN_A_HOLE)
        if seconds != stated:
            self._builder.assume(f"P of a cycle, from {LONGEST_IN_A_HOLE:g} on, is in milliseconds")
        elif stated >= 1:
            self._builder.assume(f"P of a cycle, below {LONGEST_IN_A_HOLE:g}, is in seconds")
        return seconds

    def call(self, call: HoleCall) -> None:
        """CYCLE81(…) here, MCALL CYCLE81(…) after each of the next moves and at the places of
        HOLES1(…), HOLES2(…), MCALL ends that."""
        if call.name in PATTERNS:
            self._pattern(call)
        elif call.modal:
            self._modal = call if call.name else None
        else:
            self._hole(call)

    def at_place(self) -> None:
        """The modal call where a move has led."""
        if self._modal is not None:
            self._hole(self._modal)

    def _pattern(self, call: HoleCall) -> None:
        """A row is begun at its nearer end."""
        state = self._state
        if self._modal is None or call.modal:
            raise InputError(
                f"{call.name} is read behind a line MCALL CYCLE81(…) to CYCLE89(…), which "
                "says what to drill there; found none"
            )
        found = state.unit * places(call)
        x, y, _ = state.at
        if call.name == "HOLES1" and x is not None and y is not None:
            here = np.array([x, y])
            first, last = (float(np.linalg.norm(end - here)) for end in (found[0], found[-1]))
            found = found[::-1] if last < first - 1e-9 else found
        for hole in found:
            state.at[:2] = hole.tolist()
            self._hole(self._modal)

    def _hole(self, call: HoleCall) -> None:
        """A hole by a call (Siemens) where the tool is."""
        state = self._state
        builder = self._builder
        if state.plane != 17:
            raise InputError(f"{call.name} in the plane G{state.plane}, expected G17")
        plane, cycle = cycle_of(call, state, builder.spindle.rpm)
        if call.name in NOT_CARRIED_OUT:
            builder.assume(f"{call.name}: {NOT_CARRIED_OUT[call.name]}")
        if call.name == "CYCLE85" and cycle.feed_out is None:
            builder.assume("CYCLE85 without RFF: out of the hole at the feed of the way in")
        if found := left_out(call):
            builder.assume(f"{call.name}: {found} is not carried out")
        x, y, _ = state.at
        drill_along_z(builder, state, cycle, (x, y, plane))


def drill_along_z(
    builder: ProgramBuilder,
    state: GcodeState,
    cycle: HoleCycle,
    at: tuple[float | None, float | None, float],
) -> None:
    """A hole along Z of the frame in force; the tool is at the height that the cycle leaves then.

    Args:
        builder, state: of the control; cycle: of the hole.
        at: the hole in that frame [m].

    Raises:
        InputError: the tool is not along Z.
    """
    axis = state.tilt[:3, 2]
    x, y, z = at
    point = state.placed([x, y, z])
    if builder.moved and not np.allclose(axis, builder.axis, atol=1e-6):
        raise InputError("a cycle with the tool not along its Z")
    drill(builder, cycle, point, axis)
    state.at = [x, y, z + cycle.retract]


def dwell_seconds(stated: float, longest: float = 100.0) -> float:
    """A dwell [s]: milliseconds (Fanuc) where the number is `longest` or more, else seconds."""
    return stated / 1000 if stated >= longest else stated
