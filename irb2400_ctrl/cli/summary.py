"""What a verb answers: lines for people, or with `--json` one JSON object on stdout."""

from __future__ import annotations

import functools
import inspect
import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from irb2400_ctrl.cli.command_line import answered

JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the summary as one JSON object on stdout.")
]


@dataclass(frozen=True)
class Summary:
    """What a verb has found and done.

    Args:
        facts: under their JSON names, with the unit: what the verb's JSON file says, if it has one.
        written: files and folders that were made; `written` of the object, absent without any.
        stop: what is raised once the summary is told (a log that cannot be this robot's).
    """

    facts: Mapping[str, Any]
    written: Sequence[Path] = ()
    stop: Exception | None = None

    def text(self) -> str:
        """One JSON object (RFC 8259: a number that is not finite is null)."""
        told = dict(self.facts)
        if self.written:
            told["written"] = [str(path) for path in self.written]
        return json.dumps(_plain(told), allow_nan=False)


def answers(verb: Callable[..., Summary]) -> Callable[..., None]:
    """A command with the option `--json`; with it the lines that the verb prints go to stderr."""

    @functools.wraps(verb)
    def run(context: typer.Context, *args: Any, as_json: bool = False, **kwargs: Any) -> None:
        answered.set(context)
        with redirect_stdout(sys.stderr) if as_json else nullcontext():
            found = verb(*args, **kwargs)
        if as_json:
            print(found.text())
        if found.stop is not None:
            raise found.stop

    option = inspect.Parameter(
        "as_json", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=JsonOption
    )
    # typer reads the options from here; names of annotations mean those of the verb's own module
    signature = inspect.signature(verb, eval_str=True)
    first = inspect.Parameter(
        "context", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=typer.Context
    )
    parameters = [first, *signature.parameters.values(), option]
    run.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=parameters, return_annotation=None
    )
    run.__annotations__ = {p.name: p.annotation for p in parameters} | {"return": None}
    return run


def _plain(value: Any) -> Any:
    """The value of JSON's own types; arrays and numbers of numpy know themselves how."""
    if isinstance(value, Mapping):
        return {str(key): _plain(member) for key, member in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(member) for member in value]
    if isinstance(value, str | bool | int) or value is None:
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    return str(value)
