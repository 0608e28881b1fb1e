"""What the machine around the tool is told in APT-like files: tool, spindle, coolant, stops."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.cam_program import Spindle, Tool
from irb2400_ctrl.planners.toolpath.readers.apt import frames, units
from irb2400_ctrl.planners.toolpath.readers.apt.statements import Statement, is_number, number
from irb2400_ctrl.planners.toolpath.readers.program_builder import ProgramBuilder


class Machine:
    """Carries statements out on the builder."""

    def __init__(self, builder: ProgramBuilder, *, in_one_frame: bool = False) -> None:
        self._builder = builder
        self._in_one_frame = in_one_frame
        """CSYS/ turns the part, not the points"""
        self._system: Array | None = None
        """what the first CSYS/ states"""
        self._turned = Spindle()
        """the spindle as it turned last"""
        self._do: dict[str, Callable[[Statement, float], None]] = {
            "TOOL PATH": self._tool_path,
            "TLDATA": self._tool_data,
            "CUTTER": self._cutter,
            "LOADTL": self._load,
            "LOAD": self._load_word,
            "SELECT": self._select,
            "SELCTL": self._select,
            "UNLOAD": self._select,
            "TURRET": self._load,
            "TOOLNO": self._tool_number,
            "TPRINT": self._tool_name,
            "MSYS": self._frame,
            "CSYS": self._rows,
            "TRNTYP": self._transformation,
            "SPINDL": self._spindle,
            "COOLNT": self._coolant,
            "STOP": self._stop,
            "OPSTOP": self._stop,
            "DELAY": self._delay,
            "DWELL": self._delay,
            "CUTCOM": self._compensation,
            "ORIGIN": self._origin,
            "PPRINT": self._message,
        }

    def read(self, statement: Statement, unit: float) -> bool:
        """Carry it out, if it is one of the machine's; whether it was."""
        order = self._do.get(statement.word)
        if order is None:
            return False
        order(statement, unit)
        return True

    def _tool_path(self, statement: Statement, unit: float) -> None:
        """NX: TOOL PATH/operation,TOOL,tool."""
        builder = self._builder
        words = statement.words
        split = words.index("TOOL") if "TOOL" in words else len(words)
        name = ",".join(statement.arguments[:split])
        tool = ",".join(statement.arguments[split + 1 :])
        builder.begin_operation(name)
        if tool and (tool != builder.tool.name or builder.tool.number is not None):
            builder.describe_tool(Tool(name=tool))

    def _tool_data(self, statement: Statement, unit: float) -> None:
        """NX: TLDATA/kind,diameter,corner radius,length,…"""
        values = self._numbers(statement)
        tool = self._builder.tool
        if statement.words[:1] == ["TURN"]:
            self._builder.assume("TLDATA/TURN: a turning tool; here the part does not turn")
            return
        diameter = unit * values[0] if values and values[0] > 0 else None
        length = unit * values[2] if len(values) > 2 and values[2] > 0 else None
        self._builder.describe_tool(replace(tool, diameter=diameter, length=length))

    def _cutter(self, statement: Statement, unit: float) -> None:
        """CUTTER/diameter,corner radius,e,f,a,b,height."""
        builder = self._builder
        values = self._numbers(statement)
        tool = self._described()
        if values and values[0] > 0:
            length = unit * values[6] if len(values) > 6 and values[6] > 0 else tool.length
            builder.describe_tool(replace(tool, diameter=unit * values[0], length=length))

    def _load(self, statement: Statement, unit: float) -> None:
        builder = self._builder
        numbers = [a for a in statement.arguments if is_number(a)]
        if not numbers:
            builder.change_tool(replace(self._described(), number=None))
            return
        stated = _behind("OSETNO", statement) or _behind("ADJUST", statement)
        if stated is None and len(statement.arguments) == 2 == len(numbers):
            stated = numbers[1]
        offset = None if stated is None else int(number(stated, statement.word))
        loaded = int(number(numbers[0], statement.word))
        known = self._described()
        if known.number not in {None, loaded}:
            known = Tool()
        tool = replace(known, number=loaded, length_offset=offset)
        if length := _behind("LENGTH", statement):
            tool = replace(tool, length=unit * number(length, statement.word))
        builder.change_tool(tool)

    def _described(self) -> Tool:
        """What was said about the next tool; nothing of the one in the spindle."""
        builder = self._builder
        return builder.tool if builder.tool_described or not builder.moved else Tool()

    def _load_word(self, statement: Statement, unit: float) -> None:
        """NX: LOAD/TOOL,number,ADJUST,register."""
        if "TOOL" not in statement.words:
            self._builder.ignore("LOAD/ of no tool")
            return
        self._load(statement, unit)

    def _select(self, statement: Statement, unit: float) -> None:
        self._builder.ignore(f"{statement.word}/: the magazine only")

    def _tool_number(self, statement: Statement, unit: float) -> None:
        """CATIA: TOOLNO/number,diameter or TOOLNO/number,MILL,number,…"""
        values = self._numbers(statement)
        tool = self._described()
        if values:
            tool = replace(tool, number=int(values[0]))
        beside = all(map(is_number, statement.arguments[:2])) and len(values) > 1
        if beside and values[1] > 0:
            tool = replace(tool, diameter=unit * values[1])
        self._builder.describe_tool(tool)

    def _tool_name(self, statement: Statement, unit: float) -> None:
        self._builder.describe_tool(replace(self._described(), name=statement.text))

    def _frame(self, statement: Statement, unit: float) -> None:
        builder = self._builder
        values = statement.numbers()
        builder.set_frame(frames.of_axes(values, unit))

    def _rows(self, statement: Statement, unit: float) -> None:
        """CSYS/ with three rows of four numbers. The points are those of this frame; where it is
        seen from which other one stays open, so that all must be the same.

        Raises:
            InputError: another frame than that of the points before it.
        """
        builder = self._builder
        X = frames.of_rows(statement.numbers(), unit)
        if self._in_one_frame:
            builder.axis = X[:3, 2]
            builder.assume(
                "CSYS/ turns and the points behind it state its z axis as the tool's: all are in "
                "one frame"
            )
            return
        if self._system is None and not builder.moved:
            self._system = X
        known = np.eye(4) if self._system is None else self._system
        if not np.allclose(X, known):
            raise InputError(
                "CSYS/ moves or turns the points, and whether from or to the "
                "part is not known; expected the same CSYS/ in the whole file (let the CAM system "
                "write all operations in one frame)"
            )
        if not np.allclose(X, np.eye(4)):
            builder.assume("CSYS/: the points are those of this frame, of all operations")
        builder.set_frame(np.eye(4))

    def _transformation(self, statement: Statement, unit: float) -> None:
        """TRNTYP/WORLD,0,0,0"""
        builder = self._builder
        if any(self._numbers(statement)):
            raise InputError(
                f"TRNTYP/{statement.text[:40]} is not read, expected TRNTYP/WORLD,0,0,0"
            )
        builder.ignore(f"TRNTYP/{statement.text}")

    def _spindle(self, statement: Statement, unit: float) -> None:
        builder = self._builder
        found = units.spindle(statement, self._turned, builder.tool.diameter, unit)
        if found is None:
            builder.assume("SPINDL/ with a surface speed, but no diameter: speed unknown")
            return
        if found.speed > 0:
            self._turned = found
        builder.set_spindle(found)

    def _coolant(self, statement: Statement, unit: float) -> None:
        self._builder.set_coolant(" ".join(statement.words).lower() or "on")

    def _stop(self, statement: Statement, unit: float) -> None:
        kind = "stop" if statement.word == "STOP" else "optional stop"
        self._builder.stop(kind, statement.text)

    def _delay(self, statement: Statement, unit: float) -> None:
        """DELAY/seconds, DELAY/REV,turns of the spindle; DWELL/ says the same."""
        builder = self._builder
        values = self._numbers(statement)
        if len(values) != 1 or values[0] < 0:
            raise InputError(f"{statement.word}/{statement.text[:40]}, expected one time [s]")
        seconds = values[0]
        if "REV" in statement.words:
            if builder.spindle.rpm <= 0:
                raise InputError(f"{statement.word}/ in turns, but the spindle's speed is open")
            seconds *= 60 / builder.spindle.rpm
        builder.dwell(seconds)

    def _compensation(self, statement: Statement, unit: float) -> None:
        builder = self._builder
        words = set(statement.words)
        builder.event("compensation", " ".join(statement.words).lower())
        if not words & {"LEFT", "RIGHT", "ON"}:
            builder.ignore(f"CUTCOM/{' '.join(statement.words)}")
            return
        if builder.on_profile:
            raise InputError(
                "CUTCOM/ with OUTPUT_ON_PROFILE or contact contour data: the "
                "points lie on the part's edge, a tool's radius beside the path; expected those of "
                "the tool's centre (Creo: OUTPUT_ON_CENTER, NX: centerline data)"
            )
        builder.assume("CUTCOM/: the points are the tool's centre; nothing is added for its radius")

    def _origin(self, statement: Statement, unit: float) -> None:
        values = self._numbers(statement)
        if any(values[:3]):
            self._builder.assume(
                "ORIGIN/: the post-processor's zero; the points are not moved by it"
            )
        else:
            self._builder.ignore("ORIGIN/0,0,0")

    def _message(self, statement: Statement, unit: float) -> None:
        name = re.match(r"OPERATION\s+NAME\s*:?\s*(.+)", statement.text, re.IGNORECASE)
        if name:
            self._builder.begin_operation(name.group(1))
        else:
            self._builder.event("message", statement.text)

    def _numbers(self, statement: Statement) -> list[float]:
        return [number(a, statement.word) for a in statement.arguments if is_number(a)]


def _behind(word: str, statement: Statement) -> str | None:
    """The number behind a word, as written; None where there is none."""
    words = statement.words
    found = words[words.index(word) + 1] if word in words[:-1] else ""
    return found if is_number(found) else None
