"""`irb2400`: the command line. Exit 0 success, 2 the user's input was wrong, 1 our own fault."""

from __future__ import annotations

import atexit
import gc
import io
import os
import sys
import traceback
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from irb2400_ctrl.cli import (
    codegen,
    demo,
    diagnose,
    excite,
    explain,
    identify,
    log,
    robot,
    schema,
    simulate,
    sweep,
    validate,
)
from irb2400_ctrl.cli.planning import path, place, plan
from irb2400_ctrl.cli.watching import watch

TRACEBACK_VARIABLE = "IRB2400_TRACEBACK"
NEW_OBJECTS = 10_000
"""after how many cycles are looked for: modules and results, most of what a command makes, stay"""


class ReaderGone(Exception):
    """Who read the output (head, less) has had enough."""


class Commands(TyperGroup):
    """The commands; a reader that has gone is told apart from a fault, which typer does not."""

    def invoke(self, ctx: Any) -> Any:
        try:
            found = super().invoke(ctx)
            sys.stdout.flush()
        except BrokenPipeError as error:
            raise ReaderGone from error
        return found


app = typer.Typer(
    name="irb2400",
    cls=Commands,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    # plain help: no name is cut, no [unit] is taken for markup
    rich_markup_mode=None,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from irb2400_ctrl.version import VERSION

        print(f"irb2400 {VERSION}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Say it and stop."),
    ] = False,
) -> None:
    """Plan, control, simulate, generate C and diagnose an ABB IRB 2400 from one model.

    Exit code 0: done. 2: the input was wrong; a line says what was found and what was expected.
    1: a fault of irb2400 itself, or generated code that did not pass its check. 130: interrupted.
    """


app.command("demo", short_help="the main job, end to end, on the data that comes along")(demo.demo)
app.command("plan", short_help="a toolpath becomes a timed motion")(plan.plan)
app.command("place", short_help="where a part should stand")(place.place)
app.command("simulate", short_help="a motion is followed by a controller")(simulate.simulate)
app.command("sweep", short_help="a study over many drawn plants")(sweep.sweep)
app.command("codegen", short_help="a controller becomes verified C")(codegen.codegen)
app.command("diagnose", short_help="what does the model lack that a log shows?")(diagnose.diagnose)
app.command("identify", short_help="a true robot file from logs of a sound arm")(identify.identify)
app.command("validate", short_help="how true a robot file is on a log")(validate.validate)
app.command("watch", short_help="an alarm when an arm changes")(watch.watch)
app.command("excite", short_help="the motion that tells effects apart")(excite.excite)
app.command("explain", short_help="what an effect is")(explain.explain)
app.command("schema", short_help="the JSON Schema of a file, for an editor")(schema.schema)
app.add_typer(robot.app, name="robot")
app.add_typer(path.app, name="path")
app.add_typer(log.app, name="log")


def run() -> None:
    """Entry point: every error ends in plain words and an exit code, none in a traceback.

    2: the user's input was wrong. 1: our own fault, with how to report it. What a verb
    writes is moved to its name when it is whole, so nothing is half there.
    """
    from irb2400_ctrl.errors import InputError, IrbError
    from irb2400_ctrl.system import give_back_large_arrays, interrupt_outside

    gc.set_threshold(NEW_OBJECTS)
    # at the end everything goes with the process: to look for cycles then is a thirtieth of it
    atexit.register(gc.freeze)
    give_back_large_arrays()
    interrupt_outside("casadi.py")
    # as `arrays.one_thread`, before numpy is loaded; what sets another number is obeyed
    for library in ("OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    # a character that the console's code page lacks becomes a question mark, not an error
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        app()
    except InputError as error:
        _stop(2, str(error), error)
    except IrbError as error:
        _stop(1, str(error), error)
    except ReaderGone:
        # not an error of ours; what is left to flush at the end goes nowhere
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), sys.stdout.fileno())
        sys.exit(0)
    except MemoryError as error:
        _stop(1, "the memory of this machine was not enough; nothing half-written is left", error)
    except OSError as error:
        told = f"{_told(error)}; nothing half-written is left; check room and permissions"
        held = ", and whether another program, such as Excel, has the file open"
        _stop(1, told + held * isinstance(error, PermissionError), error)
    except Exception as error:
        _last_resort(error)


def _told(error: OSError) -> str:
    # of two files the second is the one that was to be replaced; the first has a name of ours
    name = error.filename2 or error.filename
    place = f"{name}: " if name else ""
    return f"{place}{error.strerror or error}"


def _stop(code: int, text: str, error: Exception) -> None:
    """The error's text, and what `summary.answers` noted of files that are none of its result."""
    print("\n".join([f"irb2400: {text}", *getattr(error, "__notes__", ())]), file=sys.stderr)
    sys.exit(code)


def _last_resort(error: Exception) -> None:
    """An error nobody thought of: where it happened, what is lost, what to send."""
    from irb2400_ctrl.version import VERSION

    if os.environ.get(TRACEBACK_VARIABLE):
        raise error
    where = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{Path(where.filename).name}:{where.lineno}"
    kind = type(error).__name__
    _stop(
        1,
        f"a fault of irb2400 {VERSION} itself ({kind} in {place}: {error}). Nothing "
        "half-written is left, earlier results are untouched. Please report it with the command "
        f"line, its input and what {TRACEBACK_VARIABLE}=1 prints before the same command",
        error,
    )


if __name__ == "__main__":
    run()
