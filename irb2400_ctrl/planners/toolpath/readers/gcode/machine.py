"""What the machine around the tool is told in G-code: M functions, tools, comments of the CAM."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import Tool
from irb2400_ctrl.planners.toolpath.readers.feed import INCH, MM
from irb2400_ctrl.planners.toolpath.readers.gcode.blocks import Block
from irb2400_ctrl.planners.toolpath.readers.gcode.cycles import dwell_seconds
from irb2400_ctrl.planners.toolpath.readers.gcode.frames import PROGRAMMED
from irb2400_ctrl.planners.toolpath.readers.gcode.siemens_words import CALLED_TOOL
from irb2400_ctrl.planners.toolpath.readers.gcode.state import COOLANT, GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

STOPS = {0: "stop", 1: "optional stop", 60: "pallet change"}
SUBPROGRAMS = {97, 98, 198}
KEPT_MODES = {70, 71, 72, 73}
"""M functions of LinuxCNC that keep G20, G91, F, … and bring them back"""
BEGIN = re.compile(r"begin operation\s*:\s*(.*)", re.IGNORECASE)
FINISH = re.compile(r"finish operation", re.IGNORECASE)
TOOL_NAME = re.compile(r"TC\s*:\s*(.*)", re.IGNORECASE)
HIDDEN_CHANGE = re.compile(r"M0?6\s*T(\d+)", re.IGNORECASE)
DIAMETER = re.compile(r"Compensated Tool Path\.\s*Diameter:\s*([\d.]+)", re.IGNORECASE)
# (Units: 'in') of FreeCAD for UC-CNC, which has neither G20 nor G21; (INCH), (ALL UNITS IN MM)
UNITS = re.compile(
    r"(?:(?:all\s+)?units?\s*(?:are|in|[:=])*\s*'?(in)'?"
    r"|(?:(?:all\s+)?units?\s*(?:are|in|[:=])*\s*)?'?(inch(?:es)?|imperial|mm|metric"
    r"|millimet(?:er|re)s?)'?)[.\s]*(?:and\b.*)?",
    re.IGNORECASE,
)
MESSAGE = re.compile(r"MSG\s*,\s*(.*)", re.IGNORECASE)


class GcodeMachine:
    """Carries out what moves no axis."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState) -> None:
        self._builder = builder
        self._state = state
        self._unit_said = (0, MM, "")
        """line, unit [m] and text of the comment that names one"""
        self._changes_at_t = False
        self._jet = False

    def survey(self, blocks: Iterable[Block]) -> None:
        """Before the first block: in a file without M6 (L6 of Siemens) T itself is the change; in
        one with M7 and M8, but neither M9 nor a spindle, M8 ends what M7 starts."""
        functions: set[float] = set()
        self._changes_at_t = True
        for block in blocks:
            functions.update(block.codes("M"))
            if 6 in block.codes("L") or any(HIDDEN_CHANGE.match(text) for text in block.comments):
                self._changes_at_t = False
        self._changes_at_t &= 6 not in functions
        self._jet = functions >= {7, 8} and not functions & {3, 4, 9, 13, 14}

    def before(
        self, functions: list[int], values: dict[str, float], orders: tuple[str, ...]
    ) -> None:
        """What comes before the motion of a block: tool, spindle, coolant."""
        state = self._state
        builder = self._builder
        if values.get("$", 0.0) > 0:
            builder.assume(
                f"${values['$']:g}: one of several spindles or torches, taken for the one"
            )
        # M204 T500 and its like are settings of printers
        if "T" in values and max(functions, default=0) < 100:
            state.next_tool = int(values["T"])
            state.next_name = ""
            if 0 != state.next_tool != builder.tool.number:
                self._change_at_t()
        if 6 in functions:
            self._change()
        if "S" in values:
            if values["S"] < 0:
                raise InputError(f"S{values['S']}, expected at least zero")
            state.spindle_speed = values["S"]
        for function in functions:
            self._function(function)
        builder.set_spindle(state.spindle)
        for order in orders:
            self._order(order)

    def make_ready(self, tool: int) -> None:
        """The second tool of T1 T2 M6 comes with the next M6."""
        self._state.next_tool = tool
        self._state.next_name = ""
        self._builder.assume(
            "T1 T2 M6: the first tool is changed to, the second made ready (Mazak)"
        )

    def library(self, number: float) -> list[int]:
        """L6 of a control of Siemens, where it is not in the file: the change of tool, as M6.

        Raises:
            InputError: another sub-program.
        """
        if number != 6:
            raise InputError(
                f"L{number:g} calls a sub-program that is not in the file "
                "(Siemens); not read, put it into the file or write out its moves"
            )
        self._builder.assume("L6 changes the tool, as M6 (Siemens)")
        return [6]

    def after(self, functions: list[int]) -> None:
        """What comes after it: stops."""
        for function in functions:
            if function in STOPS:
                self._builder.stop(STOPS[function], f"M{function}")

    def comment(self, text: str) -> None:
        """FreeCAD names operations and tools in comments; messages are for the operator."""
        builder = self._builder
        if text.startswith(CALLED_TOOL):
            self._call(text.removeprefix(CALLED_TOOL).strip())
            return
        begin = BEGIN.match(text)
        name = TOOL_NAME.match(begin.group(1) if begin else text)
        hidden = HIDDEN_CHANGE.match(text)
        diameter = DIAMETER.search(text)
        message = MESSAGE.match(text)
        unit = UNITS.fullmatch(text)
        if name:
            known = builder.tool if builder.tool.name == name.group(1) else Tool()
            builder.describe_tool(replace(known, name=name.group(1)))
        if begin:
            builder.begin_operation(begin.group(1))
        elif FINISH.match(text):
            builder.begin_operation("")
        elif hidden and builder.tool_described:
            builder.describe_tool(replace(builder.tool, number=int(hidden.group(1))))
            builder.assume(f"the tool's number from the comment ({text})")
        elif diameter and float(diameter.group(1)) > 0:
            value = float(diameter.group(1)) * self._state.unit
            builder.describe_tool(replace(builder.tool, diameter=value))
        elif unit:
            self._unit(20 if (unit[1] or unit[2])[0] in "iI" else 21, text)
        elif message:
            builder.event("message", message.group(1))

    def dwell(self, values: dict[str, float]) -> dict[str, float]:
        """G4 P, X or F: seconds, or milliseconds where there are very many; what is left of the
        block: a move in it comes after the dwell (LinuxCNC)."""
        builder = self._builder
        word = next((letter for letter in "PXF" if letter in values), "")
        if not word and "S" in values and self._state.siemens:
            return self._dwell_in_turns(values)
        stated = values.get(word, -1.0)
        if stated < 0:
            raise InputError(
                "G4 states no time, expected G4 P, X or F, on a control of Siemens also S"
            )
        seconds = dwell_seconds(stated)
        if seconds != stated:
            builder.assume("a dwell of 100 or more is in milliseconds")
        elif "P" in values and stated >= 1:
            builder.assume("G4 P of less than 100 is in seconds")
        builder.dwell(seconds)
        return {key: value for key, value in values.items() if key != word}

    def _dwell_in_turns(self, values: dict[str, float]) -> dict[str, float]:
        """G4 S of a control of Siemens: as many turns of the spindle; what is left of the block.

        Raises:
            InputError: the spindle stands, or a negative number.
        """
        builder = self._builder
        turns = values["S"]
        if turns < 0 or builder.spindle.rpm <= 0:
            raise InputError(
                f"G4 S{turns:g} waits for turns of the spindle (Siemens); expected a positive "
                "number and a spindle that runs (S and M3 before it), or seconds (G4 F)"
            )
        builder.dwell(60 * turns / builder.spindle.rpm)
        return {key: value for key, value in values.items() if key != "S"}

    def _unit(self, code: int, text: str) -> None:
        """A comment names the unit of lengths: it counts where no code has said one."""
        state = self._state
        if not state.unit_stated:
            state.set_units(code)
            state.unit_stated = False
        self._unit_said = (self._builder.line, INCH if code == 20 else MM, text)

    def unit_said(self) -> None:
        """At the end: a comment that named the unit in the place of a code, or against it."""
        line, said, text = self._unit_said
        state = self._state
        if not text or state.unit_fixed:
            return
        self._builder.line = line
        if not state.unit_stated:
            state.unit_stated = True
            self._builder.assume(f"the unit of lengths from the comment ({text})")
        elif said != state.unit:
            found = "mm (G21)" if state.unit == MM else "inch (G20)"
            self._builder.assume(
                f"the comment ({text}) and the code differ: lengths are in {found}; if the comment "
                f"is right, --units {'inch' if said == INCH else 'mm'}"
            )

    def _change(self) -> None:
        builder = self._builder
        known = builder.tool if builder.tool_described else Tool()
        self._state.turning &= not builder.moved
        name = self._state.next_name or known.name
        builder.change_tool(replace(known, number=self._state.next_tool, name=name))

    def _change_at_t(self) -> None:
        """The change of tool that T is in a file without M6."""
        if self._changes_at_t:
            self._builder.assume("no M6 in the whole file: T itself changes the tool")
            self._change()

    def _call(self, name: str) -> None:
        """A tool by its name, for the next M6 (Siemens)."""
        self._state.next_tool = None
        self._state.next_name = name
        if name != self._builder.tool.name:
            self._change_at_t()

    def _function(self, function: int) -> None:
        builder = self._builder
        if function in {3, 4, 5, 13, 14}:
            self._state.turn_spindle(function)
            builder.set_spindle(self._state.spindle)
            if function > 5:
                builder.set_coolant("flood")
        elif self._jet and function in {7, 8}:
            builder.set_coolant(COOLANT[7 if function == 7 else 9])
            builder.assume(
                "neither a spindle nor M9 in the whole file: M7 starts and M8 ends the jet or beam"
            )
        elif function in COOLANT:
            builder.set_coolant(COOLANT[function])
        elif function in {128, 129}:
            self._control_tool_centre(on=function == 128)
        elif function in {428, 429}:
            self._control_tool_centre(on=function == 428)
            builder.assume("M428 is tool centre control, M429 its end (LinuxCNC's demos)")
        elif function in SUBPROGRAMS:
            raise InputError(
                f"M{function} calls a sub-program that is not in the file, or by a line's number "
                "(P, Q, H); not read, put it into the file as O… or write out its moves"
            )
        elif function in KEPT_MODES and self._state.linuxcnc:
            raise InputError(
                f"M{function} keeps G20, G91, F and other modes or brings them "
                "back (LinuxCNC); not read, write the codes out where they change"
            )
        elif function == 99:
            builder.assume("M99: the control begins again here; carried out once")
        elif function in {48, 49}:
            builder.ignore(f"M{function}")
        elif function not in {6, *STOPS, *self._state.ends}:
            builder.assume(f"M{function}: a function of the machine, not carried out")

    def _control_tool_centre(self, *, on: bool) -> None:
        if on:
            self._state.tool_centre = True
        else:
            self._state.end_tool_centre(self._builder.axis)

    def _order(self, order: str) -> None:
        if order in {"TRAORI", "TRAFOOF"}:
            self._control_tool_centre(on=order == "TRAORI")
        elif order in {"ORIMKS", "ORIAXES", "ORIWKS", "ORIVECT", "ORIPLANE"}:
            self._state.evenly = order in {"ORIMKS", "ORIAXES"}
        elif order not in {"SUPA", *PROGRAMMED}:
            self._builder.ignore(order)
