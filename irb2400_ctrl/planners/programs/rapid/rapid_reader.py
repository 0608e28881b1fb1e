"""Read a RAPID module back: the subset that this library writes, run in the order of execution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid.rapid_check import (
    called_first,
    calls,
    loaded_file,
    recursion,
)
from irb2400_ctrl.planners.programs.rapid.rapid_forms import (
    FORMS,
    name_fault,
    predefined,
    statement_fault,
    value_fault,
)
from irb2400_ctrl.planners.programs.rapid.rapid_moves import RapidModule, RapidMove
from irb2400_ctrl.planners.programs.rapid.rapid_syntax import (
    Module,
    Operand,
    Procedure,
    Statement,
    parse_rapid,
)
from irb2400_ctrl.planners.programs.rapid.rapid_tokens import LARGEST_TEXT
from irb2400_ctrl.typed import typed

__all__ = ["RapidModule", "RapidMove", "load_rapid", "read_rapid"]

MOST_STATEMENTS = 300_000
"""that a program may execute; what calls the same procedures again and again soon has more"""
_DEEPEST = 50
_ACTIONS = {"SetDO", "SetAO", "SetGO", "PulseDO", "WaitDI", "Stop", "TPWrite"}
_NO_POSE: list[Any] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]]
_OWN: dict[str, Any] = {
    "tool0": [True, _NO_POSE, [0.0, [0.0, 0.0, 0.0]]],
    "wobj0": [False, True, "", _NO_POSE, _NO_POSE],
}


@typed
def load_rapid(path: Path | str) -> RapidModule:
    """The program in a file; the modules that it loads stand beside it.

    Raises:
        InputError: no such file, too large, not text, or as `read_rapid`.
    """
    path = Path(path)
    text = _content(path)
    parts = {}
    for procedure in parse_rapid(text).procedures:
        for statement in procedure.statements:
            if statement.name == "Load" and not statement_fault(statement):
                name = loaded_file(statement)
                parts[name] = _content(path.parent / name)
    return read_rapid(text, parts)


@typed
def read_rapid(text: str, parts: Mapping[str, str] | None = None) -> RapidModule:
    """The module in `text`.

    Args:
        parts: the modules that it loads, by the names of their files.

    Raises:
        InputError: not the subset of RAPID that this library writes, procedures that call
        themselves, or more statements than a program has; names the statement.
    """
    module = parse_rapid(text)
    others = {name: parse_rapid(part) for name, part in (parts or {}).items()}
    procedures = _procedures(module, others)
    entry = module.procedures[0]
    _refuse_endless(module.name, entry, procedures)
    reader = _Reader(module, others, procedures)
    reader.run(entry)
    if not reader.moves:
        raise InputError(f"RAPID module {module.name}: found no moves")
    tool = reader.named(reader.tool, "tooldata")
    com = [1e-3 * float(value) for value in tool[2][1]]
    return RapidModule(
        module.name,
        _pose(tool[1]),
        float(tool[2][0]),
        (com[0], com[1], com[2]),
        tuple(reader.moves),
        tuple(reader.pauses),
        tuple(reader.actions),
    )


def _content(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST_TEXT:
            raise InputError(
                f"RAPID module {path.name}: found {path.stat().st_size:,} bytes, expected at most "
                f"{LARGEST_TEXT:,}"
            )
        return path.read_text(encoding="ascii")
    except UnicodeDecodeError as error:
        raise InputError(
            f"RAPID module {path.name}: byte {error.start} is not ASCII, expected a module as this "
            "library writes it"
        ) from error
    except (OSError, ValueError) as error:
        raise InputError(f"RAPID module {path.name}: cannot be read ({error})") from error


def _procedures(module: Module, others: Mapping[str, Module]) -> dict[str, Procedure]:
    """All procedures by name in small letters."""
    found: dict[str, Procedure] = {}
    for one in (module, *others.values()):
        for procedure in one.procedures:
            if procedure.name.lower() in found:
                raise InputError(f"RAPID: the procedure {procedure.name} is declared twice")
            found[procedure.name.lower()] = procedure
    return found


def _refuse_endless(module: str, entry: Procedure, procedures: dict[str, Procedure]) -> None:
    """Procedures that call themselves, or one another so often that nobody can wait for it."""
    circle = recursion(procedures)
    if circle:
        raise InputError(
            f"RAPID module {module}: procedures call themselves ({' -> '.join(circle[:8])}), "
            "expected calls that come to an end"
        )
    sizes: dict[str, int] = {}
    depths: dict[str, int] = {}
    for name in called_first([entry.name.lower()], procedures)[0]:
        called = [c for c in calls(procedures[name]) if c in procedures]
        sizes[name] = len(procedures[name].statements) + sum(sizes[c] for c in called)
        depths[name] = 1 + max((depths[c] for c in called), default=0)
        if sizes[name] > MOST_STATEMENTS or depths[name] > _DEEPEST:
            raise InputError(
                f"RAPID module {module}: the procedure {name} executes {sizes[name]:,} statements "
                f"in {depths[name]} levels of calls, expected at most {MOST_STATEMENTS:,} in "
                f"{_DEEPEST}"
            )


class _Reader:
    """Runs the procedures in order and notes what moves."""

    def __init__(
        self, module: Module, others: Mapping[str, Module], procedures: dict[str, Procedure]
    ) -> None:
        self.procedures = procedures
        self.others = others
        self.shared = _declared(module)
        # data of the part that is loaded now
        self.loaded: dict[str, dict[str, tuple[str, Operand]]] = {}
        self.moves: list[RapidMove] = []
        self.pauses: list[float] = []
        self.actions: list[tuple[int, str]] = []
        self.tool = ""
        # TCP of each tool in the flange
        self.tools: dict[str, Array] = {}
        self.wrist = False

    def run(self, procedure: Procedure) -> None:
        for statement in procedure.statements:
            self.execute(statement)

    def execute(self, statement: Statement) -> None:
        name = statement.name
        fault = statement_fault(statement)
        if name.startswith("Move") and (fault or name not in FORMS):
            raise _unread("move", statement, fault)
        if fault or (name not in FORMS and name.lower() not in self.procedures):
            raise _unread("statement", statement, fault)
        if name.startswith("Move"):
            self.moves.append(self.move(statement))
        elif name == "WaitTime":
            self.wait(float(_value(statement, 0)))
        elif name == "SingArea":
            self.wrist = statement.arguments[0].switches[0][0] == "Wrist"
        elif name in _ACTIONS:
            self.actions.append((len(self.moves), statement.text))
        elif name in {"Load", "UnLoad"}:
            self.load(statement)
        elif name not in {"ConfL", "ConfJ"}:
            called = str(_value(statement, 0)) if name == "%" else name
            if called.lower() not in self.procedures:
                raise _unread("statement", statement, f"no module has a procedure {called!r}")
            self.run(self.procedures[called.lower()])

    def wait(self, seconds: float) -> None:
        self.pauses.append(seconds)
        if self.moves:
            last = self.moves[-1]
            self.moves[-1] = replace(last, pause=last.pause + seconds)

    def load(self, statement: Statement) -> None:
        file = loaded_file(statement)
        if statement.name == "UnLoad":
            self.loaded.pop(file, None)
        elif file not in self.others:
            raise _unread("statement", statement, f"the module {file!r} is not there")
        else:
            self.loaded[file] = _declared(self.others[file])

    def move(self, statement: Statement) -> RapidMove:
        target, speed, zone, ends = (argument.operand for argument in statement.arguments)
        self.tool = str(ends)
        if self.tool not in self.tools:
            tooldata: Any = self.named(self.tool, "tooldata")
            self.tools[self.tool] = _pose(tooldata[1])
        speeds: Any = speed if isinstance(speed, list) else self.named(str(speed), "speeddata")
        duration = dict(statement.arguments[1].switches).get("T")
        stops = str(zone) == "fine" or bool(self.named(str(zone), "zonedata")[0])
        joints = statement.name == "MoveAbsJ"
        data: Any = self.named(str(target), "jointtarget" if joints else "robtarget")
        work_object = dict(statement.arguments[3].switches).get("WObj", "wobj0")
        frame: Any = self.named(str(work_object), "wobjdata")
        return RapidMove(
            statement.name,
            str(target),
            np.radians(np.array(data[0], dtype=float)) if joints else None,
            None if joints else _pose(frame[3]) @ _pose(frame[4]) @ _pose(data[:2]),
            None if joints else tuple(int(value) for value in data[2]),  # type: ignore[arg-type]
            external=tuple(float(v) for v in data[-1] if v < 8e9),
            speed_mm_s=float(speeds[0]),
            duration=None if duration is None else float(duration),  # type: ignore[arg-type]
            stops=stops,
            wrist=self.wrist,
            X_FT=self.tools[self.tool],
            unit="" if frame[1] else str(frame[2]),
        )

    def named(self, name: str, kind: str) -> Any:
        """The declared data of this name; tool0 and wobj0 are the controller's own."""
        if name in _OWN and predefined(name) == kind:
            return _OWN[name]
        for declared in (*self.loaded.values(), self.shared):
            found, value = declared.get(name, ("", None))
            if found == kind:
                return value
        raise InputError(f"RAPID: {name!r} is not declared as {kind}")


def _declared(module: Module) -> dict[str, tuple[str, Operand]]:
    """Type and value of all data of a module, each of its type's shape."""
    declared: dict[str, tuple[str, Operand]] = {}
    for one in module.declarations:
        fault = name_fault(one.name) or value_fault(one.kind, one.value)
        if fault:
            raise InputError(f"RAPID line {one.line}: cannot read the value of {one.name}: {fault}")
        if one.name in declared:
            raise InputError(f"RAPID line {one.line}: {one.name} is declared twice")
        declared[one.name] = (one.kind, one.value)
    return declared


def _unread(what: str, statement: Statement, why: str) -> InputError:
    because = f": {why}" if why else ""
    return InputError(
        f"RAPID line {statement.line}: cannot read the {what} {statement.text[:60]!r}{because}"
    )


def _value(statement: Statement, k: int) -> Any:
    return statement.arguments[k].operand


def _pose(value: Any) -> Array:
    """X of a RAPID pose [[x, y, z], [q1, q2, q3, q4]], millimetres."""
    from scipy.spatial.transform import Rotation

    X = np.eye(4)
    X[:3, 3] = 1e-3 * np.array(value[0], dtype=float)
    X[:3, :3] = Rotation.from_quat(np.roll(np.array(value[1], dtype=float), -1)).as_matrix()
    return X
