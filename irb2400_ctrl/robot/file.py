"""The robot file (TOML): read with all its problems listed at once, written so that it reads back
equal."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import BaseModel, ValidationError

from irb2400_ctrl.effects import LIBRARY, load_effects, users_files
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.reading import bounded_text, toml_tables
from irb2400_ctrl.robot.description import Robot
from irb2400_ctrl.robot.file_problems import explain
from irb2400_ctrl.robot.joint import Friction, Joint, Limits, MotorCoupling, Transmission
from irb2400_ctrl.robot.link import Body, Coupling, Link, ModifiedDH, Tool, Transform
from irb2400_ctrl.robot.outline import KeptApart, Outline, Part
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Hull, Sphere
from irb2400_ctrl.robot.uncertainty import BodyUncertainty, Uncertainty
from irb2400_ctrl.typed import typed

OTHER_MODELS = (".urdf", ".xacro", ".xml", ".mjcf")
"""suffixes of what `irb2400 robot import` reads"""


def robot_names() -> list[str]:
    """Names of the robots that come with the library."""
    folder = resources.files("irb2400_ctrl") / "robots"
    return sorted(
        Path(entry.name).stem for entry in folder.iterdir() if entry.name.endswith(".toml")
    )


@typed
def load_robot(source: str | Path) -> Robot:
    """The robot of a TOML file, or one of the library's own by name (`irb2400`).

    The Python files under its `effect_files` are run, with all rights of the user: read a
    stranger's robot file before loading it.

    Raises:
        InputError: no such file or name, or the file is not valid; all problems are listed at once.
    """
    folder = Path()
    if isinstance(source, str) and source in robot_names():
        text = (resources.files("irb2400_ctrl") / "robots" / f"{source}.toml").read_text("utf-8")
    else:
        path = Path(source)
        if not path.is_file():
            known = ", ".join(robot_names())
            found = "found a folder, " if path.is_dir() else ""
            raise InputError(
                f"no robot file {path}: {found}expected a TOML file or one of the robots {known}"
            )
        if path.suffix.lower() in OTHER_MODELS:
            raise InputError(
                f"{path} is a robot in another format, expected a robot file (TOML): make one of "
                f"it with `irb2400 robot import {path} --out arm.toml`"
            )
        text = bounded_text(path, "a robot file (TOML)")
        folder = path.parent
    try:
        data = toml_tables(text, str(source), "a robot file (TOML)")
        data["effect_files"] = _loaded(data.get("effect_files", []), folder, str(source))
        return Robot.model_validate(data)
    except ValidationError as error:
        raise InputError(explain(str(source), "robot", error, _tables())) from error


@typed
def save_robot(robot: Robot, path: Path | str) -> Path:
    """Write the robot as TOML (loads again to an equal one).

    It names the files of effects that are the user's own, as seen from its folder.
    """
    path = Path(path)
    data = _stated(robot)
    files = [*robot.effect_files, *users_files(type(effect) for effect in robot.effects)]
    if files:
        # ahead of the tables
        data = {"effect_files": [_seen_from(path.parent, f) for f in dict.fromkeys(files)], **data}
    return write_atomic(path, tomli_w.dumps(data))


def _stated(robot: Robot) -> dict[str, Any]:
    """The tables of the file: without what is unknown."""
    tables = robot.model_dump(mode="json", exclude_none=True)
    for joint, table in zip(robot.joints, tables["joints"], strict=True):
        if joint.friction == Friction():
            del table["friction"]
    if not robot.uncertainty.links:
        del tables["uncertainty"]["links"]
    if not robot.effects:
        # an empty list keeps a `[[effects]]` that is written behind it from being read
        del tables["effects"]
    return tables


def _loaded(files: object, folder: Path, source: str) -> tuple[Path, ...]:
    """The files of effects of a robot file, loaded."""
    if not isinstance(files, list) or not all(isinstance(name, str) for name in files):
        raise InputError(
            f"{source}: effect_files is {files!r}; expected a list of Python files, as in "
            "effect_files = ['my_effect.py']"
        )
    try:
        return tuple(load_effects(folder / name) for name in files)
    except InputError as error:
        raise InputError(f"{source}, effect_files: {error}") from error


def _seen_from(folder: Path, file: Path) -> str:
    try:
        return Path(os.path.relpath(file, folder.resolve())).as_posix()
    except ValueError:
        return file.as_posix()  # on another drive


def _tables() -> list[type[BaseModel]]:
    """All tables that a robot file may hold, effects of the user's own included."""
    return [
        *(ModifiedDH, Transform, Body, Link, Friction, Limits, Joint, Coupling, Tool, Robot),
        *(Transmission, MotorCoupling, Uncertainty, BodyUncertainty),
        *(Outline, Part, KeptApart, Box, Capsule, Cylinder, Hull, Sphere),
        *LIBRARY.values(),
    ]
