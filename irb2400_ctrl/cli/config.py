"""`--config FILE`: options of a verb in a TOML file, named as on the command line."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from irb2400_ctrl.errors import InputError

NOT_HERE = {"help", "config", "json"}


def _take(context: typer.Context, path: Path | None) -> Path | None:
    """Make the file's values the defaults of this command; what is typed counts more."""
    if path is None or context.resilient_parsing:
        return path
    known = {}
    negations: dict[str, str] = {}
    for parameter in context.command.params:
        name = _long(parameter.opts)
        if parameter.name is not None and name not in NOT_HERE:
            known[name] = parameter.name
            negations |= {_long([other]): name for other in parameter.secondary_opts}
    stated = {
        key.replace("_", "-"): value for key, value in _tables(path, context.info_name).items()
    }
    for other, name in negations.items():
        if isinstance(stated.get(other), bool):
            stated[name] = not stated.pop(other)
    unknown = sorted(set(stated) - set(known))
    if unknown:
        raise InputError(
            f"{path}: found {', '.join(unknown)}; expected options of "
            f"{context.command_path}: {', '.join([*known, *negations])}"
        )
    values = {known[key]: value for key, value in stated.items()}
    context.default_map = {**(context.default_map or {}), **values}
    return path


def _long(names: list[str]) -> str:
    return max(names, key=len).lstrip("-").replace("_", "-")


def _tables(path: Path, verb: str | None) -> dict[str, Any]:
    """The keys of the file for a verb: those at its top, then those of the verb's own table."""
    what = "a TOML file of options"
    if not path.is_file():
        found = "a folder" if path.is_dir() else "nothing"
        raise InputError(f"--config {path}: found {found}, expected {what}")
    from irb2400_ctrl.reading import bounded_text, toml_tables

    source = f"--config {path}"
    read = toml_tables(bounded_text(path, what), source, what)
    tables = {key: value for key, value in read.items() if isinstance(value, dict)}
    shared = {key: value for key, value in read.items() if key not in tables}
    return {**shared, **tables.get(verb or "", {})}


ConfigOption = Annotated[
    Path | None,
    typer.Option(
        "--config",
        metavar="FILE",
        callback=_take,
        is_eager=True,
        help="Options in a TOML file, by name: rate = 500; in a table such as [plan] for that "
        "command only. What is typed counts more.",
    ),
]
