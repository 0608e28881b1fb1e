"""Read a RAPID module back: its tool, work object and moves, as the controller would see them.

Knows the subset of RAPID that `rapid_program` writes, and refuses anything else with the statement
it stumbled on.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid.rapid_data import check_name
from irb2400_ctrl.trajectory import Trajectory, from_angles

_DECLARATION = re.compile(r"(?:LOCAL\s+)?(?:CONST|PERS|VAR)\s+(\w+)\s+(\w+)\s*:=\s*(.*)", re.DOTALL)
# configuration data on the edge of a quadrant may be read either way [deg]
_EDGE = 1e-3


@dataclass(frozen=True)
class RapidMove:
    """One move of a module, in the order of execution."""

    instruction: str
    target: str
    q: Array | None
    """actuator angles of a jointtarget [rad], shape (6,)"""
    X_BT: Array | None
    """pose of a robtarget in the robot base, work object applied, shape (4, 4)"""
    configuration: tuple[int, int, int, int] | None
    """cf1, cf4, cf6, cfx of a robtarget"""
    external: tuple[float, ...]
    """external axes that are present [deg or mm]"""
    speed_mm_s: float
    turning_speed_deg_s: float
    duration: float | None
    """argument T [s]"""
    stops: bool
    """ends in a stop point"""
    wrist: bool
    """runs under SingArea Wrist"""
    pause: float = 0.0
    """waiting time after it [s]"""


@dataclass(frozen=True)
class RapidModule:
    """What a module says."""

    name: str
    X_FT: Array
    """TCP in the flange, shape (4, 4)"""
    mass_kg: float
    com_m: tuple[float, float, float]
    moves: tuple[RapidMove, ...]
    pauses: tuple[float, ...]
    """waiting times in the order of execution [s]"""

    def joint_angles(self, model: Model) -> Array:
        """Actuator angles of every move [rad], shape (m, 6): jointtargets as they are, robtargets
        by closed-form inverse kinematics and their configuration data (the previous move decides
        what a singularity leaves open).

        Raises:
            InputError: the configuration of a target does not exist at its pose.
        """
        found: list[Array] = []
        for move in self.moves:
            if move.q is not None:
                found.append(move.q)
                continue
            assert move.X_BT is not None
            assert move.configuration is not None
            X_BT = move.X_BT @ np.linalg.inv(self.X_FT) @ model.robot.X_FT
            seed = found[-1] if found else None
            fits = [
                q
                for q in model.inverse_kinematics(X_BT, seed)
                if _fits(model, q, move.configuration)
            ]
            if not fits:
                raise InputError(
                    f"{self.name}, {move.target}: no joint angles with configuration "
                    f"{move.configuration}"
                )
            found.append(fits[0])
        return np.array(found)

    def trajectory(self, model: Model) -> Trajectory:
        """The motion through the targets at their stated times (argument T), from rest to rest.

        Between the targets it is a cubic spline (C2); where a controller goes there, its own
        planner decides, within the corner zones.

        Raises:
            InputError: a move states no time, or `joint_angles` fails.
        """
        untimed = next((move for move in self.moves[1:] if move.duration is None), None)
        if untimed is not None:
            raise InputError(
                f"{self.name}, {untimed.target}: found a move without its time, expected the "
                "argument T; write the module with RapidOptions(state_time=True)"
            )
        q = self.joint_angles(model)
        time = 0.0
        rows: list[tuple[float, Array]] = []
        for number, (move, angles) in enumerate(zip(self.moves, q, strict=True)):
            # the approach to the first target is no part of the motion
            time += move.duration or 0.0 if number else 0.0
            rows.append((time, angles))
            if move.pause:
                time += move.pause
                rows.append((time, angles))
        return from_angles([at for at, _ in rows], [angles for _, angles in rows])


def read_rapid(text: str) -> RapidModule:
    """The module in `text`.

    Raises:
        InputError: not the subset of RAPID that this library writes; names the statement.
    """
    bare = re.sub(r"!.*", "", text).strip()
    module = re.fullmatch(r"MODULE\s+(\w+)\s(.*)ENDMODULE", bare, re.DOTALL)
    if module is None:
        raise InputError("RAPID: found no MODULE ... ENDMODULE")
    check_name("module", module[1])
    first = re.search(r"\bPROC\b", module[2])
    if first is None:
        raise InputError(f"RAPID module {module[1]}: found no PROC")
    declared = _declarations(module[2][: first.start()])
    procedures = re.findall(r"PROC\s+(\w+)\(\)(.*?)ENDPROC", module[2][first.start() :], re.DOTALL)
    rest = re.sub(
        r"PROC\s+\w+\(\).*?ENDPROC", "", module[2][first.start() :], flags=re.DOTALL
    ).strip()
    if rest:
        raise InputError(f"RAPID module {module[1]}: cannot read {rest[:60]!r}")
    reader = _Reader(declared, {name: _statements(body) for name, body in procedures})
    reader.run(procedures[0][0])
    tools = {reader.tool} - {""}
    if len(tools) != 1:
        raise InputError(f"RAPID module {module[1]}: found no moves")
    kind, tool = reader.named(
        tools.pop(), "tooldata", [True, [[0, 0, 0], [1, 0, 0, 0]], [0, [0, 0, 0]]]
    )
    assert kind == "tooldata"
    com = tuple(1e-3 * value for value in tool[2][1])
    return RapidModule(
        module[1],
        _pose(tool[1]),
        float(tool[2][0]),
        (com[0], com[1], com[2]),
        tuple(reader.moves),
        tuple(reader.pauses),
    )


class _Reader:
    """Runs the procedures in order and notes what moves."""

    def __init__(
        self, declared: dict[str, tuple[str, Any]], procedures: dict[str, list[str]]
    ) -> None:
        self.declared = declared
        self.procedures = procedures
        self.moves: list[RapidMove] = []
        self.pauses: list[float] = []
        self.tool = ""
        self.wrist = False

    def run(self, procedure: str) -> None:
        for statement in self.procedures[procedure]:
            if statement.startswith("Move"):
                self.moves.append(self.move(statement))
            elif statement.startswith("WaitTime"):
                self.pauses.append(float(statement.removeprefix("WaitTime")))
                if self.moves:
                    last = self.moves[-1]
                    self.moves[-1] = replace(last, pause=last.pause + self.pauses[-1])
            elif statement in {"SingArea\\Wrist", "SingArea\\Off"}:
                self.wrist = statement.endswith("Wrist")
            elif statement in self.procedures:
                self.run(statement)
            elif not re.fullmatch(r"Conf[JL]\\On", statement):
                raise InputError(f"RAPID: cannot read the statement {statement!r}")

    def move(self, statement: str) -> RapidMove:
        instruction, _, rest = statement.partition(" ")
        arguments = _split(rest)
        if instruction not in {"MoveAbsJ", "MoveL"} or len(arguments) != 4:
            raise InputError(f"RAPID: cannot read the move {statement!r}")
        target, speed, zone, ends = arguments
        tool, _, work_object = (part.strip() for part in ends.partition("\\WObj:="))
        if self.tool not in {"", tool}:
            raise InputError(
                f"RAPID: {statement!r} changes the tool from {self.tool}, expected one tool for "
                "all moves"
            )
        self.tool = tool
        value, _, duration = (part.strip() for part in speed.partition("\\T:="))
        speeds = _value(value) if value.startswith("[") else self.named(value, "speeddata")[1]
        stops = zone == "fine" or bool(self.named(zone, "zonedata")[1][0])
        wanted = "jointtarget" if instruction == "MoveAbsJ" else "robtarget"
        data = self.named(target, wanted)[1]
        common: dict[str, Any] = {
            "external": tuple(float(v) for v in data[-1] if v < 8e9),
            "speed_mm_s": float(speeds[0]),
            "turning_speed_deg_s": float(speeds[1]),
            "duration": float(duration) if duration else None,
            "stops": stops,
            "wrist": self.wrist,
        }
        if wanted == "jointtarget":
            return RapidMove(
                instruction,
                target,
                np.radians(np.array(data[0], dtype=float)),
                None,
                None,
                **common,
            )
        frame = self.named(
            work_object,
            "wobjdata",
            [False, True, "", [[0, 0, 0], [1, 0, 0, 0]], [[0, 0, 0], [1, 0, 0, 0]]],
        )
        X_BT = _pose(frame[1][3]) @ _pose(frame[1][4]) @ _pose(data[:2])
        cf1, cf4, cf6, cfx = (int(value) for value in data[2])
        return RapidMove(instruction, target, None, X_BT, (cf1, cf4, cf6, cfx), **common)

    def named(self, name: str, kind: str, own: Any = None) -> tuple[str, Any]:
        """The declared data of this name; tool0 and wobj0 are the controller's own."""
        if own is not None and name in {"tool0", "wobj0"}:
            return kind, own
        if self.declared.get(name, ("", None))[0] != kind:
            raise InputError(f"RAPID: {name!r} is not declared as {kind}")
        return self.declared[name]


def _fits(model: Model, q: Array, configuration: tuple[int, int, int, int]) -> bool:
    degrees = np.degrees(q)
    for angle, quadrant in zip(degrees[[0, 3, 5]], configuration[:3], strict=True):
        if not np.floor((angle - _EDGE) / 90) <= quadrant <= np.floor((angle + _EDGE) / 90):
            return False
    _, r, k = model.singularity_factors(q)
    behind_axis, behind_arm, negative = (bool(configuration[3] & bit) for bit in (4, 2, 1))
    signs = ((r, behind_axis, 1e-9), (k, behind_arm, 1e-9), (degrees[4], negative, _EDGE))
    return all((value < 0) == wanted or abs(value) < edge for value, wanted, edge in signs)


def _declarations(text: str) -> dict[str, tuple[str, Any]]:
    declared: dict[str, tuple[str, Any]] = {}
    for statement in _statements(text):
        match = _DECLARATION.fullmatch(statement)
        if match is None:
            raise InputError(f"RAPID: cannot read the declaration {statement[:60]!r}")
        check_name("data", match[2])
        if match[2] in declared:
            raise InputError(f"RAPID: {match[2]} is declared twice")
        declared[match[2]] = (match[1], _value(match[3]))
    return declared


def _statements(text: str) -> list[str]:
    parts = [" ".join(part.split()) for part in text.split(";")]
    if parts[-1]:
        raise InputError(f"RAPID: a statement does not end in ';': {parts[-1][:60]!r}")
    return parts[:-1]


def _value(text: str) -> Any:
    """A RAPID aggregate as nested lists."""
    try:
        return json.loads(text.replace("TRUE", "true").replace("FALSE", "false"))
    except json.JSONDecodeError as error:
        raise InputError(f"RAPID: cannot read the value {text[:60]!r}") from error


def _split(text: str) -> list[str]:
    """Arguments between the commas outside brackets."""
    return [part.strip() for part in re.split(r",(?![^\[]*\])", text)]


def _pose(value: Any) -> Array:
    """X of a RAPID pose [[x, y, z], [q1, q2, q3, q4]], millimetres."""
    from scipy.spatial.transform import Rotation

    X = np.eye(4)
    X[:3, 3] = 1e-3 * np.array(value[0], dtype=float)
    X[:3, :3] = Rotation.from_quat(np.roll(np.array(value[1], dtype=float), -1)).as_matrix()
    return X
