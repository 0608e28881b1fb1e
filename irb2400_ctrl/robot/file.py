"""The robot file (TOML): read with all its problems listed at once, written so that it reads back
equal."""

from __future__ import annotations

import difflib
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import BaseModel, ValidationError

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.robot.description import (
    Body,
    Coupling,
    Link,
    ModifiedDH,
    Robot,
    Tool,
    Transform,
)
from irb2400_ctrl.robot.joint import Friction, Joint, Limits, MotorCoupling, Transmission
from irb2400_ctrl.robot.uncertainty import BodyUncertainty, Uncertainty


def robot_names() -> list[str]:
    """Names of the robots that come with the library."""
    folder = resources.files("irb2400_ctrl") / "robots"
    return sorted(
        Path(entry.name).stem for entry in folder.iterdir() if entry.name.endswith(".toml")
    )


def load_robot(source: str | Path) -> Robot:
    """The robot of a TOML file, or one of the library's own by name (`irb2400`).

    Raises:
        InputError: no such file or name, or the file is not valid; all problems are listed at once.
    """
    if isinstance(source, str) and source in robot_names():
        text = (resources.files("irb2400_ctrl") / "robots" / f"{source}.toml").read_text()
    else:
        path = Path(source)
        if not path.is_file():
            known = ", ".join(robot_names())
            raise InputError(
                f"no robot file {path}: expected a TOML file or one of the robots {known}"
            )
        text = path.read_text()
    try:
        return Robot.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source} is not TOML: {error}") from error
    except ValidationError as error:
        raise InputError(_explain(str(source), error)) from error


def save_robot(robot: Robot, path: Path | str) -> Path:
    """Write the robot as TOML (loads again to an equal one)."""
    return write_atomic(path, tomli_w.dumps(_stated(robot)))


def _stated(robot: Robot) -> dict[str, Any]:
    """The tables of the file: without what is unknown."""
    tables = robot.model_dump(mode="json", exclude_none=True)
    for joint, table in zip(robot.joints, tables["joints"], strict=True):
        if joint.friction == Friction():
            del table["friction"]
    if not robot.uncertainty.links:
        del tables["uncertainty"]["links"]
    return tables


def _explain(source: str, error: ValidationError) -> str:
    """One line per problem: where, what was found, what was expected."""
    lines = []
    for item in error.errors():
        # pydantic puts the tag of a union (ModifiedDH, the effect's kind) into the path; the file
        # has no such key
        parts = [part for part in item["loc"] if part not in {"ModifiedDH", "Transform", *LIBRARY}]
        place = "".join(
            f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in parts
        ).lstrip(".")
        if item["type"] == "extra_forbidden":
            near = difflib.get_close_matches(str(item["loc"][-1]), _keys(), n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            lines.append(f"{place}: unknown key{hint}")
        else:
            value: Any = item["input"]
            found = (
                "" if isinstance(value, dict | list | tuple | BaseModel) else f", found {value!r}"
            )
            lines.append(f"{place or 'robot'}: {item['msg'].removeprefix('Value error, ')}{found}")
    return f"{source} is not a valid robot file:\n  " + "\n  ".join(dict.fromkeys(lines))


def _keys() -> list[str]:
    tables: list[type[BaseModel]] = [
        *(ModifiedDH, Transform, Body, Link, Friction, Limits, Joint, Coupling, Tool, Robot),
        *(Transmission, MotorCoupling, Uncertainty, BodyUncertainty),
        *LIBRARY.values(),
    ]
    return sorted({key for table in tables for key in table.model_fields})
