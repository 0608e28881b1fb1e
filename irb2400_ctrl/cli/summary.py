"""What a verb answers: lines for people, or with `--json` one JSON object on stdout."""

from __future__ import annotations

import functools
import inspect
import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from irb2400_ctrl.cli.command_line import answered, inputs, read_files
from irb2400_ctrl.cli.config import ConfigOption
from irb2400_ctrl.cli.options import RobotOption, settings
from irb2400_ctrl.cli.progress import Progress, shown_as
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import plain

JsonOption = Annotated[
    bool, typer.Option("--json", help="Print the summary as one JSON object on stdout.")
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PLACE=VALUE",
        help="Change a value of the robot's description for this call: tool.body.mass_kg=25, "
        "joints.2.limits.torque_Nm=900 (counted from 1); may be given again.",
    ),
]
ProgressOption = Annotated[
    Progress,
    typer.Option("--progress", help="A bar on a terminal, lines of text, or nothing."),
]

Stamp = tuple[int, int]
"""inode and time of the last change: a file that is written anew has others"""
Standing = Mapping[str, frozenset[Stamp]]
"""name in the folder -> the stamps of the file, or of the files in the folder of that name"""

_NAMED = 6
INTERRUPTED = 130
"""exit code, as of what a shell sees end by Ctrl-C"""


@dataclass(frozen=True)
class Summary:
    """What a verb has found and done.

    Args:
        facts: under their JSON names, with the unit: what the verb's JSON file says, if it has one.
        written: files and folders that were made; `written` of the object, absent without any.
        stop: what is raised once the summary is told (a log that cannot be this robot's).
        kept: what an earlier call of the command has made and this one has gone on with.
    """

    facts: Mapping[str, Any]
    written: Sequence[Path] = ()
    stop: Exception | None = None
    kept: Sequence[Path] = ()

    def text(self) -> str:
        """One JSON object (RFC 8259: a number that is not finite is null)."""
        told = dict(self.facts)
        if self.written:
            told["written"] = [str(path) for path in self.written]
        return json.dumps(plain(told), allow_nan=False)


def wrote(facts: Mapping[str, Any], written: Sequence[Path], **more: Any) -> Summary:
    """The summary of a verb that has made files, which it names; `more` as of `Summary`."""
    print(f"written: {', '.join(map(str, written))}")
    return Summary(facts, written, **more)


def writes(*names: str) -> Callable[[Callable[..., Summary]], Callable[..., Summary]]:
    """Says which files the verb writes into `--out` that a verb may also read: none of them is
    replaced while it is read."""

    def mark(verb: Callable[..., Summary]) -> Callable[..., Summary]:
        verb.__dict__["results"] = names
        return verb

    return mark


def answers(verb: Callable[..., Summary]) -> Callable[..., None]:
    """A command with the options that all have: `--json` (with it the lines that the verb prints
    go to stderr), `--config`, `--progress`; and `--set` where it takes a robot. What an earlier run
    left in `--out` is named."""

    @functools.wraps(verb)
    def run(context: typer.Context, *args: Any, as_json: bool = False, **kwargs: Any) -> None:
        answered.set(context)
        shown_as.set(kwargs.pop("progress_as"))
        settings.set(kwargs.pop("robot_settings", None) or [])
        del kwargs["config"]
        out = kwargs.get("out")
        _spared(out, getattr(verb, "results", ()), inputs())
        before = _standing(out, read_files())
        stood = _standing(out)
        new = out is not None and not out.exists()
        try:
            with redirect_stdout(sys.stderr) if as_json else nullcontext():
                found = verb(*args, **kwargs)
        except KeyboardInterrupt:
            print(f"irb2400: interrupted; {_done(stood, _standing(out))}", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None
        except Exception as error:
            _note_left(error, out, _left_over(before, _standing(out)))
            raise
        finally:
            if new:
                _without_empty(out)
        if as_json:
            print(found.text())
        kept = {path.name for path in found.kept}
        left = [name for name in _left_over(before, _standing(out)) if name not in kept]
        # what is stopped has not made its main result
        replaced_some = len(left) < len(before) or found.stop is not None
        # a file that is put beside others says nothing of them
        put_beside = [path.is_file() for path in found.written] == [True]
        if left and replaced_some and not put_beside:
            print(f"irb2400: {_says(out, left)}", file=sys.stderr)
        if found.stop is not None:
            raise found.stop

    # typer reads the options from here; names of annotations mean those of the verb's own module
    signature = inspect.signature(verb, eval_str=True)
    first = inspect.Parameter(
        "context", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=typer.Context
    )
    own = signature.parameters.values()
    options = [_option("robot_settings", None, SetOption)] if _takes_robot(signature) else []
    options += [
        _option("config", None, ConfigOption),
        _option("progress_as", Progress.AUTO, ProgressOption),
        _option("as_json", False, JsonOption),
    ]
    parameters = [first, *own, *options]
    run.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=parameters, return_annotation=None
    )
    run.__annotations__ = {p.name: p.annotation for p in parameters} | {"return": None}
    return run


def _option(name: str, default: object, annotation: object) -> inspect.Parameter:
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation
    )


def _takes_robot(signature: inspect.Signature) -> bool:
    """Whether the verb reads a robot that `load_arm` may change."""
    found = signature.parameters.get("robot")
    return found is not None and found.annotation == RobotOption


def _standing(out: Path | None, read: Iterable[Path] = ()) -> Standing:
    """What is in the folder now, or the file, without what the command reads; nothing where there
    is none."""
    if out is None or not out.exists():
        return {}
    inputs = {path.resolve() for path in read}
    found = {}
    for entry in out.iterdir() if out.is_dir() else [out]:
        files = _files(entry)
        if files and not entry.name.startswith(".") and inputs.isdisjoint(files):
            found[entry.name] = frozenset((s.st_ino, s.st_mtime_ns) for s in map(Path.stat, files))
    return found


def _spared(out: Path | None, names: Sequence[str], read: Sequence[Path]) -> None:
    """Refuse to replace a file that the command reads."""
    if out is None:
        return
    written = {(out / name).resolve() for name in names} | {out.resolve()}
    for path in read:
        if path.resolve() in written:
            raise InputError(
                f"--out {out}: found {path}, which this command reads and would replace; expected "
                "another place for the results"
            )


def _left_over(before: Standing, now: Standing) -> list[str]:
    """Names of what the command has not written anew."""
    return sorted(name for name in before if before[name] == now.get(name))


def _note_left(error: Exception, out: Path | None, names: list[str]) -> None:
    """A refused place holds no results: of that there is nothing to say."""
    if names and not str(error).startswith("--out "):
        error.add_note(_says(out, names))


def _without_empty(out: Path | None) -> None:
    """The folder that was made goes where nothing has come into it."""
    if out is not None and out.is_dir() and not any(out.iterdir()):
        out.rmdir()


def _done(before: Standing, now: Standing) -> str:
    """What was written until an interruption."""
    names = sorted(name for name in now if now[name] != before.get(name))
    return f"written until then: {', '.join(names)}" if names else "nothing was written"


def _says(out: Path | None, names: list[str]) -> str:
    """One sentence about them."""
    if out is not None and out.is_file():
        return f"{out}: from before, and no result of this command"
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    shown = ", ".join(names[:_NAMED])
    return f"{out}: from before, and no result of this command: {shown}{more}"


def _files(entry: Path) -> list[Path]:
    entries = list(entry.iterdir()) if entry.is_dir() else [entry]
    return [path.resolve() for path in entries if path.is_file()]
