"""Places of the machine tool, which the robot has not: G28, G30, G53, SUPA, Z beside G49."""

from __future__ import annotations

from collections.abc import Iterable

from irb2400_ctrl.planners.toolpath.readers.gcode.blocks import Block
from irb2400_ctrl.planners.toolpath.readers.gcode.codes import moves
from irb2400_ctrl.planners.toolpath.readers.gcode.cycles import CYCLES
from irb2400_ctrl.planners.toolpath.readers.gcode.motion import GcodeMotion
from irb2400_ctrl.planners.toolpath.readers.gcode.state import AXES, ROTARY, GcodeState
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder

LENGTHS = frozenset([43, 43.1, 43.4, 43.5, 44])
"""codes that count a length of the tool"""


class MachinePlaces:
    """Leaves them out: where the tool then is, the file has to state anew."""

    def __init__(self, builder: ProgramBuilder, state: GcodeState, motion: GcodeMotion) -> None:
        self._builder = builder
        self._state = state
        self._motion = motion
        self._counts_lengths = False

    def survey(self, blocks: Iterable[Block]) -> None:
        """Before the first block: whether the file counts lengths of tools at all."""
        found = {round(code, 3) for block in blocks for code in block.codes("G")}
        self._counts_lengths = bool(LENGTHS & found)

    def without_height(self, codes: list[float], values: dict[str, float]) -> dict[str, float]:
        """The values without the Z of `G49 Z0`, on a control of Siemens of `D0 Z0`: the spindle
        goes there, no tip of a tool."""
        machine = {28, 30, 53} & set(codes)
        ends = "G49" if self._counts_lengths and 49 in codes else ""
        if self._state.siemens and values.get("D") == 0.0 and not CYCLES.keys() & set(codes):
            ends = "D0"
        if not ends or "Z" not in values or machine:
            return values
        self._builder.assume(
            f"Z beside {ends}, which ends the tool's length: a height of the spindle; the robot "
            "does not go there"
        )
        self._builder.leave()
        self._state.lose({"Z"})
        return {name: value for name, value in values.items() if name != "Z"}

    def go(self, codes: list[float], values: dict[str, float]) -> None:
        """G28, G30, G53 (SUPA)."""
        state = self._state
        builder = self._builder
        if 53 in codes and not moves(values):
            return
        named = [i for i, letter in enumerate(AXES) if letter in values]
        through = state.absolute or any(values[AXES[i]] != 0 for i in named)
        if 53 not in codes and named and through:
            # they hold for their block alone: the motion in force goes on behind it
            in_force = state.motion
            state.motion = 0
            self._motion.run(values)
            state.motion = in_force
        builder.assume("G28, G30, G53: places of the machine tool; the robot does not go there")
        builder.leave()
        state.lose({AXES[i] for i in named or range(3)})
        if angles := set(ROTARY) & set(values):
            state.rotary |= {name: values[name] if 53 in codes else 0.0 for name in angles}
            state.left_turned = False
