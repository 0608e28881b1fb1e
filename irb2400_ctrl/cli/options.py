"""Options that several commands share."""

from __future__ import annotations

import os
import sys
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from irb2400_ctrl.robot import Robot


def robots_named() -> list[str]:
    """Robots that come with the library: what the shell completes; where no name begins so, it
    offers files."""
    from irb2400_ctrl.robot.file import robot_names

    return robot_names()


def controllers_named() -> list[str]:
    """Controllers."""
    from irb2400_ctrl.controllers.registry import CONTROLLERS

    return list(CONTROLLERS)


def effects_named() -> list[str]:
    """Kinds of effects."""
    from irb2400_ctrl.effects.registry import LIBRARY

    return sorted(LIBRARY)


def motions_named() -> list[str]:
    """What a motion is planned for."""
    from irb2400_ctrl.excitation.groups import groups

    return ["identify", *sorted(groups()), *effects_named()]


def interpolations_named() -> list[str]:
    """How a controller reads rows."""
    return ["cubic", "linear"]


RobotOption = Annotated[
    str,
    typer.Option(
        "--robot",
        metavar="ROBOT",
        help="A robot file (TOML) or a name.",
        autocompletion=robots_named,
    ),
]
GuardedOption = Annotated[
    bool,
    typer.Option(
        "--guarded/--bare",
        help="With guards against faults of its inputs, or the controller alone.",
    ),
]
ColumnsOption = Annotated[
    Path | None,
    typer.Option(
        "--columns", metavar="MAP", help="What the log's columns are (TOML, docs/logs.md)."
    ),
]
BetweenOption = Annotated[
    str | None,
    typer.Option(
        "--between",
        metavar="FROM:TO",
        help="Only these seconds of each LOG, counted from its first sample: 100:400, 100: or "
        ":400. A CSV is read in a stream, however long.",
    ),
]
ValidateBetweenOption = Annotated[
    str | None,
    typer.Option(
        "--validate-between", metavar="FROM:TO", help="The same of the log to validate on."
    ),
]
UncertaintyOption = Annotated[
    list[str] | None,
    typer.Option(
        "--uncertainty",
        metavar="KEY=NUMBER",
        help="One standard deviation of the robot file's numbers, as in its [uncertainty]: "
        "mass_relative=0.05, com_m=0.01, link_2.mass_relative=0.2; may be given again.",
    ),
]
CellOption = Annotated[
    Path | None,
    typer.Option(
        "--cell", metavar="CELL", help="What stands around the arm (TOML, docs/cells.md)."
    ),
]
WorkFrameOption = Annotated[
    str | None,
    typer.Option(
        "--work-frame",
        metavar="X,Y,Z,RX,RY,RZ",
        help="Pose of the file's frame in the robot base [mm, deg]; turned about the base's fixed "
        "x, then y, then z.",
        show_default="the cell's work object, or the base",
    ),
]
ToolOption = Annotated[
    str | None,
    typer.Option(
        "--tool",
        metavar="NAME",
        help="A tool of the cell; else the one with the CAM file's number or name.",
        show_default="the robot file's",
    ),
]
UnitsOption = Annotated[
    str | None,
    typer.Option(
        "--units", help="Unit of length, against what the file says: mm, cm, m, inch or foot."
    ),
]
RotaryOption = Annotated[
    str | None,
    typer.Option(
        "--rotary", help="Rotary axes of the machine from part to tool, for 5-axis G-code: C,A."
    ),
]
WorkOffsetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--work-offset",
        metavar="NAME=X,Y,Z,RX,RY,RZ",
        help="Where another work frame of the control lies in the first that the file uses "
        "[mm, deg]: G55=200,0,0,0,0,0; may be given again.",
    ),
]
FreeOption = Annotated[
    bool,
    typer.Option(
        "--free-tool-rotation/--fixed",
        help="Turn the tool freely about its own axis, or hold it.",
    ),
]
OutOption = Annotated[
    Path, typer.Option("--out", metavar="DIR", help="Folder for the results; all is written there.")
]


# of what looks wrong in a robot file, told by every command
_NOTES = 3

settings: ContextVar[list[str]] = ContextVar("settings", default=[])  # noqa: B039
"""what `--set` changes in the robot of this command"""


def load_arm(robot: str, uncertainty: list[str] | None = None) -> Robot:
    """The robot, its prior changed as the user says; says on stderr what its file does not state
    and what is done without it."""
    from irb2400_ctrl.robot import load_robot

    arm = load_robot(robot)
    if settings.get():
        from irb2400_ctrl.robot.changed import changed as with_settings

        arm = with_settings(arm, settings.get())
    if uncertainty:
        bodies = [link.name for link in arm.links] + (["tool"] if arm.tool else [])
        changed = arm.uncertainty.changed(uncertainty, bodies)
        # what was identified would take the place of what was just asked for
        arm = arm.model_copy(update={"uncertainty": changed, "identified": None})
    for line in [*_looks_wrong(arm, robot), *arm.assumptions()]:
        print(f"{arm.name}: {line}", file=sys.stderr)
    return arm


def _looks_wrong(arm: Robot, source: str) -> list[str]:
    """What `robot check` would note of the numbers: the first few, and how many more, bodies that
    cannot exist in one; nothing of what the library's own robots are published with."""
    from irb2400_ctrl.model.consistency import check
    from irb2400_ctrl.model.plausibility import plausibility
    from irb2400_ctrl.robot import load_robot, robot_names
    from irb2400_ctrl.wording import joined

    published = plausibility(load_robot(source)) if source in robot_names() else []
    notes = [note for note in plausibility(arm) if note not in published]
    impossible = {one.sentence: one.place for one in check(arm) if one.sentence in notes}
    if len(impossible) > 1:
        notes = [note for note in notes if note not in impossible]
        bodies = joined(list(impossible.values()))
        notes.append(f"{bodies}: bodies that cannot exist (irb2400 robot check says why)")
    if len(notes) > _NOTES:
        left = len(notes) - _NOTES
        more = f"and {left} more that look{'s' * (left == 1)} wrong (irb2400 robot check)"
        notes = [*notes[:_NOTES], more]
    return notes


TOOLPATH = "a toolpath (CSV, APT/CLDATA, G-code or Heidenhain's .h)"


def input_file(path: Path, what: str) -> Path:
    """The path, if a file is there; InputError says what was expected otherwise."""
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.reading.looks_like import CAM_SUFFIXES

    if not path.is_file():
        found = "a folder" if path.is_dir() else "nothing"
        raise InputError(f"{path}: found {found}, expected {what}; check the path")
    if what != TOOLPATH and path.suffix.lower() in CAM_SUFFIXES:
        raise InputError(
            f"{path}: found a CAM file, expected {what}; `irb2400 plan` makes a motion of it, "
            "trajectory.csv"
        )
    return path


def output_folder(out: Path, option: str = "--out") -> Path:
    """The folder, made if missing; InputError when a file is in the way, or nothing may be written
    there."""
    from irb2400_ctrl.errors import InputError

    if out.exists() and not out.is_dir():
        raise InputError(f"{option} {out}: found a file, expected a folder or a new name")
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{option} {out}: cannot make the folder ({error.strerror}); choose another place"
        ) from error
    if not os.access(out, os.W_OK):
        raise InputError(
            f"{option} {out}: found a folder that may not be written to; choose another place, or "
            "ask for the right to write there"
        )
    return out


def output_file(out: Path, option: str = "--out") -> Path:
    """The name of a file to write, its folder made if missing; InputError where that cannot be."""
    from irb2400_ctrl.errors import InputError

    if out.exists() and not out.is_file():
        found = "a folder" if out.is_dir() else "a device"
        raise InputError(f"{option} {out}: found {found}, expected the name of a file")
    output_folder(out.parent, option)
    return out
