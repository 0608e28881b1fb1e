"""Options of `irb2400 plan` for the RAPID module, and its files."""

from __future__ import annotations

import re
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from irb2400_ctrl.errors import InputError

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.planners import Plan, ProgramMotion
    from irb2400_ctrl.planners.programs.rapid import RapidOptions, RapidProgram
    from irb2400_ctrl.planners.toolpath.cam_program import Operation
    from irb2400_ctrl.robot import Robot

RapidOption = Annotated[
    bool, typer.Option("--rapid", help="Also write the motion as a RAPID module, program.mod.")
]
RapidSetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--rapid-set",
        metavar="KEY=VALUE",
        help="How it is written, such as tool=tSpindle, zone_mm=1, targets_per_module=2000 "
        "(docs/programs_out.md); may be given again.",
    ),
]
RapidIoOption = Annotated[
    list[str] | None,
    typer.Option(
        "--rapid-io",
        metavar="EVENT=FORM:NAME",
        help="What an event of the CAM file does: spindle=SetDO:doSpindle, tool=PulseDO:doChange, "
        "tool=Stop; may be given again.",
    ),
]


def rapid_options(
    wanted: bool, settings: list[str] | None, signals: list[str] | None
) -> RapidOptions | None:
    """What the options say; None where no module is wanted. A setting asks for a module, too.

    Raises:
        InputError: an unknown key, or a value that cannot be.
    """
    from irb2400_ctrl.planners.programs.rapid import RapidOptions
    from irb2400_ctrl.planners.programs.rapid.rapid_signals import RapidSignal

    if not (wanted or settings or signals):
        return None
    types = {f.name: str(f.type) for f in fields(RapidOptions) if f.name != "signals"}
    values: dict[str, Any] = {"signals": tuple(RapidSignal.of(text) for text in signals or [])}
    for text in settings or []:
        key, found, value = (part.strip() for part in text.partition("="))
        if key not in types or not found:
            raise InputError(
                f"--rapid-set: found {text!r}, expected KEY=VALUE with one of {', '.join(types)}"
            )
        values[key] = _value(key, value, types[key])
    return RapidOptions(**values)


def _value(key: str, text: str, kind: str) -> Any:
    readers: dict[str, Any] = {"int": int, "float": float, "float | None": float, "bool": _yes}
    try:
        return readers.get(kind, str)(text)
    except ValueError as error:
        what = {"int": "a whole number", "bool": "yes or no"}.get(kind, "a number")
        raise InputError(f"--rapid-set {key}: found {text!r}, expected {what}") from error


def _yes(text: str) -> bool:
    if text.lower() not in {"yes", "no", "true", "false"}:
        raise ValueError(text)
    return text.lower() in {"yes", "true"}


def write_plan_module(
    plan: Plan, operation: Operation | None, options: RapidOptions, X_BW: Array | None, out: Path
) -> list[str]:
    """The module of one plan; the names of its files."""
    from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_plan

    return _save(rapid_of_plan(plan, operation, options, X_BW=X_BW), plan.robot, out)


def write_motion_module(
    motion: ProgramMotion, options: RapidOptions, X_BW: Array | None, out: Path
) -> list[str]:
    """The module of a whole program; the names of its files."""
    from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import rapid_of_motion

    return _save(rapid_of_motion(motion, options, X_BW=X_BW), motion.plans[0].robot, out)


def _save(program: RapidProgram, robot: Robot, out: Path) -> list[str]:
    program.save(out / "program.mod")
    if not re.search("abb|irb", robot.name, re.IGNORECASE):
        print(
            "note: program.mod is RAPID, which only ABB's controllers run; the robot is "
            f"{robot.name}. For other controllers take trajectory.csv"
        )
    if program.not_written:
        told = "; ".join(dict.fromkeys(program.not_written))
        print(f"program.mod only shows, because --rapid-io names no signal: {told[:300]}")
    return ["program.mod", *program.parts]
