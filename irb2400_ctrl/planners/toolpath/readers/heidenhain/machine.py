"""What the machine around the tool is told in plain language: tools, spindle, M functions."""

from __future__ import annotations

import re

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import Tool
from irb2400_ctrl.planners.toolpath.readers.feed import INCH, Feed
from irb2400_ctrl.planners.toolpath.readers.gcode.state import COOLANT, GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

_TOOL = re.compile(
    r'^TOOL\s+CALL\s*("[^"]*"|\+?\d+(?:\.\d+)?)?\s*([XYZUVW](?![\w.]))?\s*(.*)$', re.IGNORECASE
)
_SPEED = re.compile(r"\bS\s*\+?(\d+\.?\d*)")
_FEED = re.compile(r"\bF\s*\+?(\d+\.?\d*)")
_LONGER = re.compile(r"\bD[LR]\d*\s*([-+]?\d*\.?\d+)")
STOPS = {0: "stop", 1: "optional stop"}
# paths of rotary axes, handwheel, look-ahead, corners of compensated contours, retreat, limits
QUIET = frozenset([2, 6, 30, 89, 91, 92, 94, 97, 98, 99, 107, 108, 116, 117, 118, 120, 126, 127])
FEEDS = {
    103: "plunging is not slowed down",
    109: "feeds of arcs stay those of the tip",
    110: "feeds of arcs stay those of the tip",
    111: "feeds of arcs stay those of the tip",
}


class PlainMachine:
    """Carries out what moves no axis."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState) -> None:
        self._builder = builder
        self._state = state
        self._heading = ""
        self.tool_feed: float | None = None
        """F of the TOOL CALL, as it states it"""

    def heading(self, text: str) -> None:
        """`* - NAME`: of what comes next."""
        self._heading = text

    def named(self, *, apart: bool) -> None:
        """An operation begins here where a heading is open and the tool is not in a cut."""
        if self._heading and apart:
            self._builder.begin_operation(self._heading)
        self._heading = ""

    def tool(self, code: str) -> None:
        """TOOL CALL 4 Z S1592 F500 DL+0.1; without a tool only what it states besides.

        Raises:
            InputError: another tool axis than Z.
        """
        builder = self._builder
        found = _TOOL.match(code)
        if found is None:
            builder.ignore("TOOL DEF: the magazine only")
            return
        if found[2] and found[2] != "Z":
            raise InputError(f"TOOL CALL with the tool axis {found[2]}; expected Z")
        if found[1]:
            self.named(apart=True)
            numbered = found[1][0] != '"'
            name = "" if numbered else found[1].strip('"')
            self._change(Tool(int(float(found[1])) if numbered else None, name))
        if speed := _SPEED.search(found[3]):
            self._state.spindle_speed = float(speed[1])
            builder.set_spindle(self._state.spindle)
        if feed := _FEED.search(found[3]):
            self.tool_feed = float(feed[1])
            builder.feed = self._state.feed(self.tool_feed)
        if any(float(number) for number in _LONGER.findall(found[3])):
            builder.assume("DL, DR of TOOL CALL: the tool's oversize is not applied")

    def _change(self, tool: Tool) -> None:
        """To another tool; a call of the one in the spindle lets it turn on."""
        builder = self._builder
        known = builder.tool
        if builder.moved and (tool.number, tool.name) == (known.number, known.name):
            return
        self._state.turning &= not builder.moved
        builder.change_tool(tool)

    def feed(self, number: float) -> Feed:
        """F in the unit in force; InputError where it is negative."""
        if number < 0:
            raise InputError(f"F{number:g}, expected a positive feed")
        return self._state.feed(number)

    def before(self, functions: list[int]) -> None:
        """What acts as the block begins."""
        builder = self._builder
        for function in functions:
            if function in {3, 4, 13, 14}:
                self._state.turn_spindle(function)
                builder.set_spindle(self._state.spindle)
                if function > 4:
                    builder.set_coolant("flood")
            elif function in {7, 8}:
                builder.set_coolant(COOLANT[function])
            elif function == 128:
                self._state.tool_centre = True
            elif function in {136, 137}:
                self._per_turn(function == 136)
                builder.feed = Feed()
            elif function in FEEDS:
                builder.assume(f"M{function}: {FEEDS[function]}")
            elif function not in {5, 9, 129, 140, *STOPS, *QUIET}:
                builder.assume(f"M{function}: a function of the machine, not carried out")

    def after(self, functions: list[int]) -> None:
        """What acts at its end."""
        builder = self._builder
        for function in functions:
            if function == 5:
                self._state.turn_spindle(function)
                builder.set_spindle(self._state.spindle)
            elif function == 9:
                builder.set_coolant("off")
            elif function in STOPS:
                builder.stop(STOPS[function], f"M{function}")

    def _per_turn(self, on: bool) -> None:
        if on and self._state.unit == INCH:
            raise InputError(
                "M136 in a program in INCH: whether F counts inches or "
                "their tenths per turn is not known here; expected FU"
            )
        self._state.feed_mode = 95 if on else 94
