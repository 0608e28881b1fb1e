"""`read_heidenhain`: plain language of Heidenhain's controls (.h) as a `CamProgram`."""

from __future__ import annotations

import re
from collections.abc import Mapping

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram
from irb2400_ctrl.planners.toolpath.readers.feed import INCH, LENGTHS, MM
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import Rotary
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.heidenhain.flow import Flow
from irb2400_ctrl.planners.toolpath.readers.heidenhain.machine import PlainMachine
from irb2400_ctrl.planners.toolpath.readers.heidenhain.motion import PlainMotion
from irb2400_ctrl.planners.toolpath.readers.heidenhain.statements import (
    NUMBER,
    Statement,
    as_number,
    statements,
)
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.unread_line import UnreadLineError

_MOVES = re.compile(r"^(LN|LP|L|CC|CR|CP|C)(?=\s|$)\s*(.*)$")
_CYCLE = re.compile(r"^CYCLE?\s+DEF\s*(\d+)(?:\s*\.(\d+))?\s*(.*)$")
_CALL = re.compile(r"^CYCLE?\s+CALL\s*(POS|PAT|M(?=\d))?\s*(.*)$")
# kinds of machining, parallel axes that the file does not move, pulses, counters
_QUIET_FUNCTION = re.compile(
    r"FUNCTION\s+(MODE\s+MILL|PARAXCOMP|PROG\s+PATH|FEED|S-PULSE|DCM|COUNT)"
)
QUIET_CYCLES = {13: "orientation of the spindle", 32: "tolerance", 332: "tolerance"}
MAKERS_END = 800
"""from here on cycles turn and mill where they are called"""
REFUSED = {
    8: "mirroring",
    11: "scaling",
    12: "a program of another file",
    26: "scaling",
    220: "a pattern of holes",
    221: "a pattern of holes",
    224: "a pattern of holes",
}
UNREAD = {
    "TRANS": "a frame that is mirrored, turned or scaled (of TRANS, DATUM is read)",
    "CT": "an arc by its tangent; of arcs C with CC, CP and CR are read",
    "RND": "a rounded corner; let the CAM system write the arc",
    "CHF": "a chamfer; let the CAM system write the line",
    "APPR": "an approach that the control makes; let the CAM system write its moves",
    "DEP": "a departure that the control makes; let the CAM system write its moves",
    "TCH": "a probe",
    "CALL": "a program of another file",
    "SEL": "a program or table of another file",
    "PATTERN": "a pattern of holes; let the CAM system write a block for each",
}


def read_heidenhain(
    text: str,
    builder: ProgramBuilder,
    units: str | None,
    rotary: Rotary | None,
    frames: Mapping[str, Array],
) -> CamProgram:
    """All operations of a program in plain language.

    Args:
        text: of the file.
        builder: that takes the moves.
        units: unit of length, against BEGIN PGM.
        rotary: the machine's rotary axes from part to tool.
        frames: poses of presets in the first one, by their keys.

    Raises:
        InputError: a block that is not read, with its line.
    """
    reader = _Reader(builder, units, rotary, frames)
    for block in Flow(statements(text)).blocks():
        with builder.reading(block.line):
            if isinstance(block, UnreadLineError):
                raise block
            reader.block(block)
    return builder.finish("Heidenhain", reader.unit_name(), True)


class _Reader:
    """Goes through the blocks in the order in which they are carried out."""

    def __init__(
        self,
        builder: ProgramBuilder,
        units: str | None,
        rotary: Rotary | None,
        frames: Mapping[str, Array],
    ) -> None:
        self._builder = builder
        self._state = GcodeState()
        self._units = units
        self._rotary = rotary
        self._machine = PlainMachine(builder, self._state)
        self._motion = PlainMotion(builder, self._state, self._machine, rotary, frames)

    def unit_name(self) -> str:
        """For the summary."""
        return self._units or ("inch" if self._state.unit == INCH else "mm")

    def block(self, block: Statement) -> None:
        """One of them.

        Raises:
            InputError: it is not read.
        """
        builder = self._builder
        code = block.code
        if block.optional:
            builder.assume("blocks behind / are carried out")
        if block.heading is not None:
            self._machine.heading(block.heading)
        elif code.startswith("BEGIN PGM"):
            self._begin(code)
        elif code.startswith(("END PGM", "BLK FORM")):
            builder.ignore(code[:8])
        elif code.startswith("TOOL"):
            self._machine.tool(code)
        elif code.startswith("CYCL"):
            self._cycle(code)
        elif code.startswith("TRANS DATUM"):
            self._motion.frames.transform(code)
        elif code.startswith("PLANE"):
            self._motion.frames.plane(code)
        elif code.startswith("FUNCTION"):
            self._function(code)
        elif code.startswith("STOP"):
            builder.stop("stop", "STOP")
            self._motion.run("", code[4:])
        elif re.match(r"M\d", code):
            self._motion.run("", code)
        elif found := _MOVES.match(code):
            self._motion.run(found[1], found[2])
        else:
            word = re.split(r"[^A-Z]", code)[0]
            why = UNREAD.get(word, "not known")
            raise InputError(f"found {code[:30]!r}: {why}; not read")

    def _begin(self, code: str) -> None:
        """BEGIN PGM NAME MM, or INCH, where feeds are in tenths of an inch."""
        state = self._state
        unit = code.split()[-1]
        if unit not in {"MM", "INCH", "IN"} and not self._units:
            raise InputError(f"found {code!r}, expected BEGIN PGM, a name, and MM or INCH")
        inch = unit in {"INCH", "IN"}
        state.unit = LENGTHS[self._units] if self._units else (INCH if inch else MM)
        state.feed_unit = state.unit
        state.unit_stated = True
        if inch and not self._units:
            state.feed_unit = 0.1 * INCH
            self._builder.assume("a program in INCH: feeds are in tenths of inch/min")

    def _cycle(self, code: str) -> None:
        builder = self._builder
        if found := _CALL.match(code):
            self._called(found[1] or "", found[2])
            return
        found = _CYCLE.match(code)
        if found is None:
            raise InputError(f"found {code[:30]!r}, expected CYCL DEF or CYCL CALL")
        number = int(found[1])
        part = found[2]
        rest = found[3]
        if number in {7, 8, 9, 10, 11, 12, 13, 19, 26, 32} and part == "0":
            return
        if number == 7:
            self._motion.frames.shift(rest)
        elif number == 10:
            self._motion.frames.turn(rest)
        elif number == 9:
            self._dwell(rest)
        elif number == 19:
            self._tilt(rest)
        elif number == 247:
            row = re.search(r"Q339\s*=\s*\+?(\d+)", rest)
            self._state.work_offset = f"preset {row[1] if row else '?'}"
            self._motion.frames.preset()
        elif number in QUIET_CYCLES:
            builder.ignore(f"CYCL DEF {number}: {QUIET_CYCLES[number]}")
        elif number in REFUSED:
            if number != 8 or rest:
                raise InputError(
                    f"CYCL DEF {number} is {REFUSED[number]}; not read, let the "
                    "CAM system write the moves"
                )
        elif 300 <= number < MAKERS_END:
            says = f"CYCL DEF {number}: a cycle of the machine's maker, not carried out"
            builder.assume(says)
        elif part in {None, "0"}:
            self._motion.cycles.define(number, rest)

    def _called(self, how: str, rest: str) -> None:
        if how == "PAT":
            raise InputError(
                "CYCL CALL PAT takes its places from a table or pattern; "
                "not read, let the CAM system write a block for each"
            )
        if how == "POS":
            self._motion.call_at(rest)
        else:
            self._motion.drill()
        if how == "M":
            self._motion.run("", f"M{rest}")

    def _dwell(self, rest: str) -> None:
        found = re.search(NUMBER, rest)
        if found is None:
            raise InputError("CYCL DEF 9.1 without a time")
        self._builder.dwell(abs(as_number(found[0])))

    def _tilt(self, rest: str) -> None:
        """CYCL DEF 19.1: angles in space or of the axes, as a setting of the control says."""
        if any(as_number(n) for n in re.findall(NUMBER, rest)):
            raise InputError(
                f"CYCL DEF 19.1 {rest[:30]}: whether these are angles in "
                "space or of the axes is set in the control; expected PLANE SPATIAL"
            )
        self._motion.frames.plane("PLANE RESET STAY")

    def _function(self, code: str) -> None:
        state = self._state
        if re.match(r"FUNCTION\s+RESET\s+TCPM", code):
            self._motion.without_centre()
            self._motion.motion.steer(self._rotary)
        elif re.match(r"FUNCTION\s+TCPM", code):
            if "CENTER-CENTER" in code:
                raise InputError(
                    "REFPNT CENTER-CENTER: places of the ball's centre, "
                    "whose radius the control knows; expected those of the tip"
                )
            state.tool_centre = True
            state.evenly = re.search(r"PATHCTRL\s+VECTOR", code) is None
            # angles in space turn about the fixed axes x, y, z
            space = re.search(r"AXIS\s+SPAT", code)
            self._motion.motion.steer(Rotary.of("C,B,A") if space else self._rotary)
        elif _QUIET_FUNCTION.match(code):
            self._builder.ignore(code[:30])
        else:
            raise InputError(f"found {code[:30]!r}, which is not read")
