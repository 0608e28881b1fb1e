"""`read_gcode`: 3-axis and 5-axis G-code (ISO 6983; LinuxCNC, Fanuc, FreeCAD) as a `CamProgram`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram
from irb2400_ctrl.planners.toolpath.readers.feed import LENGTHS
from irb2400_ctrl.planners.toolpath.readers.gcode.blocks import Block, blocks
from irb2400_ctrl.planners.toolpath.readers.gcode.codes import (
    EXACT_STOP,
    EXACT_STOPS,
    HARMLESS,
    MOTION,
    REFUSED,
    SPECIAL,
    moves,
    refuse_idle_words,
    without_owned,
)
from irb2400_ctrl.planners.toolpath.readers.gcode.control import is_linuxcnc, is_siemens
from irb2400_ctrl.planners.toolpath.readers.gcode.cycles import CYCLES
from irb2400_ctrl.planners.toolpath.readers.gcode.decimal_points import without_point
from irb2400_ctrl.planners.toolpath.readers.gcode.firmware.printer import (
    PLASTIC,
    is_printers,
    without_plastic,
)
from irb2400_ctrl.planners.toolpath.readers.gcode.firmware.settings import without_settings
from irb2400_ctrl.planners.toolpath.readers.gcode.frames import GcodeFrames
from irb2400_ctrl.planners.toolpath.readers.gcode.machine import GcodeMachine
from irb2400_ctrl.planners.toolpath.readers.gcode.machine_places import MachinePlaces
from irb2400_ctrl.planners.toolpath.readers.gcode.macros.variables import Variables
from irb2400_ctrl.planners.toolpath.readers.gcode.motion import GcodeMotion
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import LEFT_TURNED, Rotary
from irb2400_ctrl.planners.toolpath.readers.gcode.state import SPLINES, GcodeState
from irb2400_ctrl.planners.toolpath.readers.gcode.subprograms import in_order
from irb2400_ctrl.planners.toolpath.readers.gcode.swivel import swivel
from irb2400_ctrl.planners.toolpath.readers.gcode.work_offsets import WorkOffsets
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.unread_line import TooMuchError, UnreadLineError


def read_gcode(
    text: str,
    builder: ProgramBuilder,
    units: str | None,
    rotary: Rotary | None,
    frames: Mapping[str, Array],
) -> CamProgram:
    """All operations of a G-code file.

    Args:
        text: of the file.
        builder: that takes the moves.
        units: unit of length, against G20 and G21.
        rotary: the machine's rotary axes from part to tool.
        frames: poses of work frames such as G55 in the first one, by their keys.

    Raises:
        InputError: a word that is not known or not read, with its line.
    """
    name = builder.name
    siemens = is_siemens(text, name)
    state = GcodeState(siemens=siemens, evenly=not siemens, linuxcnc=is_linuxcnc(text, name))
    if is_printers(text):
        state.printers = True
        text = without_plastic(text)
        builder.line = 1
        builder.assume(PLASTIC)
    reader = _Reader(builder, state, units, rotary, frames)
    variables = Variables(siemens=siemens, linuxcnc=state.linuxcnc)
    lines, notes = in_order(text, name, variables)
    try:
        listed = list(blocks(lines, variables))
    except TooMuchError as error:
        raise builder.placed(error) from error
    reader.survey([block for block in listed if isinstance(block, Block)])
    for index, block in enumerate(listed):
        if reader.ended:
            with builder.reading(block.line):
                reader.after_end(listed[index:])
            break
        with builder.reading(block.line):
            if isinstance(block, UnreadLineError):
                raise block
            reader.block(block)
    with builder.reading(builder.line):
        reader.end()
    points = [] if state.printers else without_point(text, name)
    for builder.line, note in [*notes, *points]:
        builder.assume(note)
    return builder.finish("G-code", reader.unit_name(), reader.unit_stated)


class _Reader:
    """Goes through the blocks; within a block in the order of RS-274."""

    def __init__(
        self,
        builder: ProgramBuilder,
        state: GcodeState,
        units: str | None,
        rotary: Rotary | None,
        frames: Mapping[str, Array],
    ) -> None:
        self._builder = builder
        self._state = state
        if units is not None:
            self._state.unit = LENGTHS[units]
            self._state.feed_unit = LENGTHS[units]
            self._state.unit_fixed = True
        self._units = units
        self._motion = GcodeMotion(builder, self._state, rotary)
        self._machine = GcodeMachine(builder, self._state)
        self._frames = GcodeFrames(builder, self._state)
        self._offsets = WorkOffsets(builder, self._state, frames)
        self._places = MachinePlaces(builder, self._state, self._motion)
        self._moved = False
        self._again = False
        self.ended = False

    @property
    def unit_stated(self) -> bool:
        """G20, G21 or the user said so."""
        return self._state.unit_stated or self._state.unit_fixed

    def unit_name(self) -> str:
        """For the summary."""
        if self._units is not None:
            return self._units
        self._machine.unit_said()
        if not self._state.unit_stated:
            self._builder.line = 1
            self._builder.assume("neither G20 nor G21 in the file: lengths in mm")
        return "mm" if self._state.unit == LENGTHS["mm"] else "inch"

    def end(self) -> None:
        """Nothing may be left open."""
        self._motion.splines.none_open()
        self._frames.end()

    def survey(self, listed: list[Block]) -> None:
        """What the whole file says of single blocks."""
        words = {letter for block in listed for letter in block.values()}
        if "Z" not in words and {"X", "Y"} & words:
            self._flat()
        self._machine.survey(listed)
        self._places.survey(listed)
        self._motion.cycles.survey(listed)

    def _flat(self) -> None:
        """No Z in the whole file, as for lasers and plotters."""
        self._state.at[2] = 0.0
        self._builder.line = 1
        self._builder.assume("no Z in the whole file: Z is 0")

    def after_end(self, rest: list[Block | UnreadLineError]) -> None:
        """None of the blocks after the end is read; after M99 they are another program."""
        lost = sum(isinstance(block, Block) and moves(block.values()) for block in rest)
        if self._again:
            raise InputError(
                "a block after M99, so that the program before it may be a sub-program; not read, "
                "expected all moves in one program"
            )
        if lost:
            self._builder.assume(
                f"the program has ended: {lost} blocks with places behind it are left out"
            )

    def block(self, block: Block) -> None:
        """One line."""
        builder = self._builder
        if block.tape_mark:
            # the one behind places closes what the first one opens
            self.ended = self._moved
            return
        for comment in block.comments:
            self._machine.comment(comment)
        for note in block.assumed:
            builder.assume(note)
        block = without_settings(block, builder)
        values = block.checked()
        codes = [round(code, 3) for code in block.codes("G")]
        codes += [53.0] * ("SUPA" in block.orders)
        if self._motion.cycles.return_level(codes, values):
            return
        if {5, 5.1} & set(codes) and not moves(values, by_centre=True):
            # Fanuc's G5 P10000, G5.1 Q1; with places they are splines
            builder.ignore("G5, G5.1: look-ahead")
            codes = [code for code in codes if code not in {5, 5.1}]
        if 4 in codes:
            values = self._machine.dwell(values)
        functions = [int(code) for code in block.codes("M")]
        in_cycle = CYCLES.keys() & {*codes, self._state.motion}
        if self._state.siemens and "L" in values and not in_cycle:
            functions += self._machine.library(values.pop("L"))
        if in_cycle:
            functions = self._motion.cycles.returns(functions)
        if block.plane is not None:
            swivel(block.plane, self._state, builder)
        self._modes(codes, values)
        values = self._places.without_height(codes, without_owned(codes, values, builder))
        self._machine.before(functions, values, block.orders)
        if block.ready is not None:
            self._machine.make_ready(block.ready)
        used = self._special(codes, values, block.orders)
        self._set_motion(codes)
        leads = not used and moves(values, by_centre=self._state.by_centre)
        if leads and self._state.motion == 80:
            self._after_cycle()
        if leads:
            refuse_idle_words(self._state, (codes, functions), values)
            self._move(values)
            self._moved = True
            self._motion.cycles.at_place()
        if block.call is not None:
            self._motion.cycles.call(block.call)
        self._machine.after(functions)
        self.ended = bool(self._state.ends & set(functions))
        self._again = 99 in functions

    def _modes(self, codes: list[float], values: dict[str, float]) -> None:
        state = self._state
        builder = self._builder
        for code in self._offsets.select(codes, values):
            self._mode(code)
        if "F" in values:
            if values["F"] < 0:
                raise InputError(f"F{values['F']}, expected a positive feed")
            builder.feed = state.feed(values["F"])
        if "H" in values and {43, 43.1, 43.4, 43.5, 234} & set(codes):
            builder.set_length_offset(int(values["H"]))

    def _mode(self, code: float) -> None:
        state = self._state
        simple: dict[float, Callable[[], None]] = {
            15: lambda: setattr(state, "polar", False),
            16: lambda: setattr(state, "polar", True),
            17: lambda: setattr(state, "plane", 17),
            18: lambda: setattr(state, "plane", 18),
            19: lambda: setattr(state, "plane", 19),
            20: lambda: state.set_units(20),
            21: lambda: state.set_units(21),
            70: lambda: self._unit_of_lengths(20),
            71: lambda: self._unit_of_lengths(21),
            700: lambda: state.set_units(20),
            710: lambda: state.set_units(21),
            90: lambda: setattr(state, "absolute", True),
            91: lambda: setattr(state, "absolute", False),
            90.1: lambda: setattr(state, "arc_absolute", True),
            91.1: lambda: setattr(state, "arc_absolute", False),
            93: lambda: self._feed_mode(93),
            94: lambda: self._feed_mode(94),
            95: lambda: self._feed_mode(95),
            98: lambda: setattr(state, "retract_to_start", True),
            99: lambda: setattr(state, "retract_to_start", False),
            43: lambda: state.end_by_length(self._builder.axis),
            43.1: lambda: state.end_by_length(self._builder.axis),
            43.4: state.begin_by_length,
            43.5: lambda: state.begin_by_length(vectors=True),
            49: lambda: state.end_tool_centre(self._builder.axis),
            234: state.begin_by_length,
            254: lambda: self._motion.follow(True),
            255: lambda: self._motion.follow(False),
        }
        if code in simple:
            simple[code]()
        elif code in REFUSED:
            raise InputError(f"G{code:g} is {REFUSED[code]}; not read")
        elif code in HARMLESS:
            self._builder.ignore(f"G{code:g}")
        elif code in EXACT_STOPS:
            self._builder.assume(EXACT_STOP)
        elif code not in MOTION and code not in SPECIAL:
            raise InputError(f"unknown code G{code:g}")

    def _unit_of_lengths(self, code: int) -> None:
        """G70, G71: of lengths alone on a control of Siemens, where feeds stay in the basic unit of
        the machine; else of feeds, too."""
        self._state.set_units(code, feeds=not self._state.siemens)
        if code == 21 or self._state.unit_fixed:
            return
        self._builder.assume(
            "G70 (Siemens): lengths in inch, feeds still in mm, the machine's basic unit; for both "
            "in inch G700, or --units inch"
            if self._state.siemens
            else "G70 is taken for G20, lengths and feeds in inch. On a control of Siemens feeds "
            "stay in mm: if the file is for one, give it the ending .mpf; if not, --units inch"
        )

    def _feed_mode(self, mode: int) -> None:
        if mode != self._state.feed_mode:
            self._state.feed_mode = mode
            self._builder.feed = type(self._builder.feed)()

    def _special(
        self, codes: list[float], values: dict[str, float], orders: tuple[str, ...]
    ) -> bool:
        """Codes that take the axis words for something else; whether one did."""
        if self._frames.run(codes, values, orders):
            return True
        if {28, 30, 53} & set(codes):
            self._places.go(codes, values)
            return True
        return 28.1 in codes

    def _after_cycle(self) -> None:
        """Axis words after G80: G0 or G1 from before the cycle goes on (Fanuc)."""
        before = self._state.before_cycle
        if before is None:
            raise InputError("found axis words after G80; expected G0, G1, G2, G3 or a cycle")
        self._builder.assume(f"after G80 the motion before the cycle goes on (G{before})")
        self._state.motion = before

    def _set_motion(self, codes: list[float]) -> None:
        found = [code for code in codes if code in MOTION]
        # G80 ends a cycle, and says nothing against a motion beside it: G0 G17 G40 G49 G80 G90
        found = [code for code in found if code != 80] or found
        if 80 in codes:
            self._state.cycle.clear()
        if len(set(found)) > 1:
            raise InputError(
                f"found G{found[0]:g} and G{found[1]:g} in one block, expected one motion"
            )
        if found:
            if found[0] in {0, 1}:
                self._state.before_cycle = int(found[0])
            if found[0] not in SPLINES:
                self._motion.splines.none_open()
            self._state.motion = found[0]
            if found[0] not in CYCLES:
                self._state.cycle.clear()

    def _move(self, values: dict[str, float]) -> None:
        state = self._state
        if state.feed_mode == 93 and state.motion in {1, 2, 3, 5, 5.1} and "F" not in values:
            raise InputError("G93 (inverse time) needs F in every cutting block")
        if state.left_turned and state.motion != 0 and not state.tool_centre:
            raise InputError(f"{LEFT_TURNED}")
        self._offsets.used()
        self._motion.run(values)
