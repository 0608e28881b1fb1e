"""A robot with single values of its description changed, by their place in the robot file."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from typing import Any

from pydantic import ValidationError

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.description import Robot
from irb2400_ctrl.robot.file_problems import explain


def changed(robot: Robot, settings: Sequence[str]) -> Robot:
    """The robot with `settings` such as `tool.body.mass_kg=25` or `joints.2.limits.torque_Nm=900`.

    Joints and links are counted from 1, or named; a value is written as in TOML.

    Raises:
        InputError: no such place, or a value that cannot be.
    """
    data = robot.model_dump(mode="json")
    for text in settings:
        place, found, value = text.partition("=")
        keys = [key.strip() for key in place.split(".")]
        if not found or not all(keys):
            raise InputError(
                f"--set: found {text!r}, expected PLACE=VALUE, as tool.body.mass_kg=25"
            )
        table = data
        for key in keys[:-1]:
            table = _inside(table, key, text)
        last = _key(table, keys[-1], text)
        table[last] = _value(value.strip())
    try:
        return Robot.model_validate(data)
    except ValidationError as error:
        raise InputError(explain(f"--set {' '.join(settings)}", "robot", error, [Robot])) from error


def _inside(table: Any, key: str, text: str) -> Any:
    found = table[_key(table, key, text)]
    if not isinstance(found, dict | list):
        raise InputError(f"--set {text}: {key} is a value, expected a table of the robot file")
    return found


def _key(table: Any, key: str, text: str) -> Any:
    """Where `key` stands in a table or a list of tables."""
    if isinstance(table, list):
        names = [item.get("name") if isinstance(item, dict) else None for item in table]
        if key in names:
            return names.index(key)
        if key.isdigit() and 1 <= int(key) <= len(table):
            return int(key) - 1
        raise InputError(f"--set {text}: found {key!r}, expected a number 1 to {len(table)}")
    if key not in table:
        raise InputError(f"--set {text}: found {key!r}, expected one of {', '.join(table)}")
    return key


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
