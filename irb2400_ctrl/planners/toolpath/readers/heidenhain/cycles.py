"""Holes of Heidenhain's plain language: `CYCL DEF 200 … Q200=+2 …`, called by M99, M89, CYCL CALL.

Source: Heidenhain, TNC 640 User's Manual for Cycle Programming, "Fixed cycles: drilling".
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import MOST_STEPS, HoleCycle
from irb2400_ctrl.planners.toolpath.readers.feed import Feed
from irb2400_ctrl.planners.toolpath.readers.gcode.cycles import drill_along_z
from irb2400_ctrl.planners.toolpath.readers.gcode.state import GcodeState
from irb2400_ctrl.planners.toolpath.readers.heidenhain.machine import PlainMachine
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

KINDS = {
    200: "peck",
    201: "bore",
    202: "bore",
    203: "peck",
    205: "peck",
    206: "bore",
    207: "bore",
    209: "bore",
    240: "drill",
    241: "drill",
}
NOT_CARRIED_OUT = {
    201: "out of the hole at the feed of the way in",
    202: "out of the hole at the feed of the way in, without its way aside",
    203: "back by 0.254 mm at each of its steps; Q213 and Q256 (how often and how far back for "
    "chips) are not carried out",
    205: "no chip breaking between the steps; each comes out of the hole",
    206: "the spindle is not turned the other way for the way out",
    207: "the spindle is not turned the other way for the way out",
    209: "in one go, the spindle is not turned the other way for the way out",
    241: "at one feed from the clearance on; speed and coolant stay",
}
"""what the robot does otherwise than the control"""
ASKED_BY = {203: 213}
"""the Q that asks for it, where not every call of the cycle does"""
_Q = re.compile(r"Q(\d+)\s*=\s*(\+?-?\s*(?:\d+\.?\d*|\.\d+)|[-+]?[A-Z]+[\d.]*)")


@dataclass(frozen=True)
class Definition:
    """What the next calls do."""

    number: int
    values: dict[int, float]
    name: str


class PlainCycles:
    """Carries them out."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState, machine: PlainMachine) -> None:
        self._builder = builder
        self._state = state
        self._machine = machine
        self._defined: Definition | None = None
        self.modal = False
        """each positioning is followed by the cycle (M89)"""

    def define(self, number: int, code: str) -> None:
        """Keep a cycle for its calls.

        Raises:
            InputError: a value that another block or the control states.
        """
        values = {}
        for key, text in _Q.findall(code):
            word = text.lstrip("+-")
            if word[0].isalpha():
                # Q208= MAX: rapid
                automatic = word in {"AUTO", "FAUTO"} and self._machine.tool_feed is not None
                if word == "PREDEF" or (key == "206" and not automatic):
                    raise InputError(
                        f"found Q{key}={word}, expected a number"
                        + (", or FAUTO with F in TOOL CALL" if key == "206" else "")
                    )
                if key == "206":
                    values[206] = self._machine.tool_feed or 0.0
                continue
            values[int(key)] = float(text.replace(" ", "").replace("+-", "-"))
        name = re.split(r"\bQ\d+\s*=", code)[0].strip()
        self._defined = Definition(number, values, f"CYCL DEF {number} {name}".strip())

    def call(self, above: float = 0.0) -> None:
        """The defined cycle where the tool is.

        Args:
            above: how far the surface lies above that of the definition [m].

        Raises:
            InputError: none is defined, one that is not read, or values that contradict.
        """
        state = self._state
        builder = self._builder
        defined = self._defined
        if defined is None:
            raise InputError("a cycle is called, and none is defined; expected CYCL DEF")
        if defined.number not in KINDS:
            known = ", ".join(map(str, KINDS))
            raise InputError(
                f"{defined.name} is not read; expected one of the cycles {known}, or let "
                "the CAM system write its moves"
            )
        asked_by = ASKED_BY.get(defined.number)
        asked = asked_by is None or defined.values.get(asked_by)
        if defined.number in NOT_CARRIED_OUT and asked:
            builder.assume(f"CYCL DEF {defined.number}: {NOT_CARRIED_OUT[defined.number]}")
        cycle = self._cycle(defined)
        x, y, _ = state.at
        surface = defined.values.get(203, 0.0) * state.unit + above
        drill_along_z(builder, state, cycle, (x, y, surface))

    def _cycle(self, defined: Definition) -> HoleCycle:
        values = defined.values
        unit = self._state.unit
        clear = values.get(200, 0.0)
        depth = -values.get(201, 0.0)
        if depth <= 0 or clear < 0:
            raise InputError(
                f"{defined.name} with Q201={values.get(201, 0.0):g} and Q200={clear:g}; "
                "expected a negative depth and a positive clearance"
            )
        if defined.number == 240 and values.get(343, 0.0):
            raise InputError("CYCL DEF 240 by a diameter (Q343=1); expected its depth")
        if values.get(395, 0.0):
            raise InputError(
                f"{defined.name} to a depth of the drill's full diameter (Q395=1): how far its tip "
                "goes on is in the control's table of tools; expected the depth of the tip (Q395=0)"
            )
        kind = KINDS[defined.number]
        if defined.number == 203 and values.get(213, 0.0):
            kind = "chip"
        steps = _steps(values, clear, depth) if kind in {"peck", "chip"} else ()
        return HoleCycle(
            kind if steps or kind not in {"peck", "chip"} else "drill",
            depth * unit,
            clear * unit,
            max(values.get(204, 0.0), clear) * unit,
            tuple(step * unit for step in steps),
            values.get(211, 0.0),
            self._feed(defined),
            defined.name,
        )

    def _feed(self, defined: Definition) -> Feed | None:
        """Q206, or pitch times speed."""
        values = defined.values
        if defined.number in {207, 209}:
            speed = self._builder.spindle.speed / (2 * np.pi)
            if not speed or not values.get(239):
                raise InputError(
                    f"CYCL DEF {defined.number} without a speed of the spindle or a "
                    "pitch (Q239); expected both"
                )
            return Feed("speed", abs(values[239]) * self._state.unit * speed)
        if 206 not in values:
            return None
        return Feed("speed", values[206] * self._state.feed_unit / 60)


def _steps(values: dict[int, float], clear: float, depth: float) -> tuple[float, ...]:
    """Q202 first, less by Q212 each time, at least Q205; the first counts from the clearance."""
    first = values.get(202, 0.0)
    if not 0 < first < depth:
        return ()
    less = values.get(212, 0.0)
    least = values.get(205, first) or first
    steps = [first + clear]
    reached = first
    step = first
    while less > 0 and reached < depth and len(steps) < MOST_STEPS:
        step = max(step - less, min(least, step))
        steps.append(step)
        reached += step
    return tuple(steps) if less > 0 else (first + clear, first)
