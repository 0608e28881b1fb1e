"""`read_apt`: NX CLSF, Creo NCL, CATIA aptsource and plain APT/CLDATA as a `CamProgram`."""

from __future__ import annotations

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram
from irb2400_ctrl.planners.toolpath.readers.apt import units
from irb2400_ctrl.planners.toolpath.readers.apt.comments import Comments
from irb2400_ctrl.planners.toolpath.readers.apt.from_the_bottom import from_the_bottom
from irb2400_ctrl.planners.toolpath.readers.apt.machine import Machine
from irb2400_ctrl.planners.toolpath.readers.apt.motion import Motion
from irb2400_ctrl.planners.toolpath.readers.apt.statements import COMMENT, Statement, statements
from irb2400_ctrl.planners.toolpath.readers.apt.systems import in_one_frame
from irb2400_ctrl.planners.toolpath.readers.apt.vocabulary import (
    CALLS,
    IGNORED,
    MACHINE_CODE,
    MOVING,
    STEERED,
    TURNING,
)
from irb2400_ctrl.planners.toolpath.readers.feed import LENGTHS
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder
from irb2400_ctrl.planners.toolpath.readers.unread_line import UnreadLineError


def read_apt(text: str, dialect: str, builder: ProgramBuilder, units: str | None) -> CamProgram:
    """All operations of an APT-like file.

    Args:
        text: of the file.
        builder: that takes the moves.
        dialect: "NX CLSF", "Creo NCL", "CATIA aptsource" or "APT".
        units: unit of length, against what the file says.

    Raises:
        InputError: a statement that cannot be read, or that may move the tool and is not known; the
            message has its line.
    """
    program = list(statements(text))
    unit_of = _Units([s for s in program if isinstance(s, Statement)], units, builder)
    motion = Motion(builder, dialect, from_the_bottom(program))
    machine = Machine(builder, in_one_frame=in_one_frame(program))
    comments = Comments(builder)
    for statement in program:
        with builder.reading(statement.line):
            if isinstance(statement, UnreadLineError):
                raise statement
            unit = unit_of.at(statement.line)
            if statement.word == COMMENT:
                comments.read(statement.text, unit)
            elif not (motion.read(statement, unit) or machine.read(statement, unit)):
                _rest(builder, statement)
    with builder.reading(builder.line):
        motion.end()
    _behind_the_end(program, builder)
    return builder.finish(dialect, unit_of.name, unit_of.stated)


def _rest(builder: ProgramBuilder, statement: Statement) -> None:
    """Words that move nothing are noted; all others refused."""
    word = statement.word
    if word in TURNING and _turns_nothing(statement):
        builder.ignore(f"{word}/ by zero")
    elif word in MOVING or (word in STEERED and statement.arguments):
        raise InputError(
            f"{word}/ moves the tool or the part and is not read; expected "
            "GOTO/, GODLTA/, CIRCLE/ or MOVARC/ (let the CAM system write points)"
        )
    elif word in CALLS:
        raise InputError(
            f"{word}/{statement.text[:40]} calls a program that is kept in the "
            "control, and what it moves is not known here; delete the line if it moves nothing, "
            "else let the CAM system write its points"
        )
    elif word in MACHINE_CODE:
        builder.assume(f"{word}/{statement.text[:60]}: machine code, not carried out")
    elif word in IGNORED:
        builder.ignore(f"{word}/")
    else:
        shown = f"{word}/{statement.text[:40]}" if statement.text else word
        raise InputError(
            f"unknown statement {word!r} ({shown}); expected APT/CLDATA such as GOTO/x,y,z,i,j,k"
        )


def _behind_the_end(program: list[Statement | UnreadLineError], builder: ProgramBuilder) -> None:
    """Of several programs in one file it is said that all are carried out."""
    read = [s for s in program if isinstance(s, Statement)]
    ends = [s.line for s in read if s.word == "FINI"]
    places = [s.line for s in read if s.word in {"GOTO", "GODLTA"}]
    if ends and places and places[-1] > ends[0]:
        builder.line = ends[0]
        builder.assume(
            "FINI/ ends the program, and places follow: carried out as well, one after another"
        )


def _turns_nothing(statement: Statement) -> bool:
    numbers = [a for a in statement.arguments if a[:1] in "+-.0123456789"]
    return bool(numbers) and all(n.strip("+-0.") == "" for n in numbers)


class _Units:
    """The unit of length at each line: one `UNITS/` anywhere holds for the whole file."""

    def __init__(
        self, program: list[Statement], asked: str | None, builder: ProgramBuilder
    ) -> None:
        stated = units.stated_units(program, builder.name)
        self._steps: list[tuple[int, float]] = []
        self.stated = bool(stated) or asked is not None
        if asked is not None:
            self.name = asked
        elif not stated:
            self.name = units.units_of_feeds(program) or "mm"
            why = "as its feeds" if units.units_of_feeds(program) else "the default"
            builder.line = 1
            builder.assume(f"no UNITS/ in the file: lengths in {self.name}, {why}")
        else:
            self.name = stated[0][1]
            if any(unit != self.name for _, unit in stated):
                self._steps = [(line, LENGTHS[unit]) for line, unit in stated[1:]]
        self._first = LENGTHS[self.name]

    def at(self, line: int) -> float:
        """The unit [m]."""
        unit = self._first
        for start, later in self._steps:
            if line >= start:
                unit = later
        return unit
