"""The command line that is being answered, as text that repeats it, and a report's provenance."""

from __future__ import annotations

import shlex
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from irb2400_ctrl.report.elements.provenance import Provenance
    from irb2400_ctrl.robot import Robot


answered: ContextVar[typer.Context | None] = ContextVar("answered", default=None)
"""the command that is being answered"""


def command_line() -> str:
    """Arguments first, then what was stated otherwise than by default, in the order of the help."""
    context = answered.get()
    if context is None:
        return ""
    words: list[str] = []
    above: typer.Context | None = context
    while above is not None and above.parent is not None:
        words.insert(0, above.info_name or "")
        above = above.parent  # type: ignore[assignment]
    arguments: list[str] = []
    options: list[str] = []
    for parameter in context.command.params:
        name = parameter.name or ""
        value = context.params.get(name)
        source = context.get_parameter_source(name)
        if value is None or source is None or source.name == "DEFAULT":
            continue
        if parameter.param_type_name == "argument":
            arguments += _texts(value)
        else:
            # how it was shown says nothing of the result; a config file's options stand here
            if name not in {"config", "progress_as", "as_json"}:
                options += _option(parameter, value)
    return shlex.join(["irb2400", *words, *arguments, *options])


def read_files() -> list[Path]:
    """Files that the command line names and that are there."""
    return [v for v in _values() if isinstance(v, Path) and v.is_file()]


def inputs() -> list[Path]:
    """The same with those that may also be named otherwise (a robot)."""
    return [Path(v) for v in _values() if isinstance(v, str | Path) and _is_file(v)]


def _values() -> list[Any]:
    """What was given, but for the place of the results."""
    context = answered.get()
    params = {} if context is None else context.params
    values = [value for name, value in params.items() if name != "out"]
    return [v for value in values for v in (value if isinstance(value, list | tuple) else [value])]


def _is_file(name: str | Path) -> bool:
    try:
        return Path(name).is_file()
    # a word that no file can have for its name
    except (OSError, ValueError):
        return False


def provenance(robot: Robot | None = None, **more: Any) -> Provenance:
    """Of this command line: the files that it names, the robot, and what else went in."""
    from irb2400_ctrl.report.elements.provenance import Provenance

    return Provenance.of(robot, read_files(), command_line(), **more)


def _option(parameter: Any, value: Any) -> list[str]:
    if isinstance(value, bool):
        names = parameter.opts if value else parameter.secondary_opts
        return [max(names, key=len)] if names else []
    name = max(parameter.opts, key=len)
    return [word for text in _texts(value) for word in (name, text)]


def _texts(value: Any) -> list[str]:
    return [str(v) for v in value] if isinstance(value, list | tuple) else [str(value)]
