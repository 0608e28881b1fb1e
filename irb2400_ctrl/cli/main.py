"""`irb2400`: the command line. Exit 0 success, 2 the user's input was wrong, 1 our own fault."""

from __future__ import annotations

import sys

import typer

from irb2400_ctrl.cli import (
    codegen,
    demo,
    diagnose,
    excite,
    identify,
    log,
    path,
    plan,
    robot,
    simulate,
    sweep,
    validate,
)

app = typer.Typer(
    name="irb2400",
    help="Plan, control, simulate, generate C and diagnose an ABB IRB 2400 from one model.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
)
app.command("demo")(demo.demo)
app.command("plan")(plan.plan)
app.command("simulate")(simulate.simulate)
app.command("sweep")(sweep.sweep)
app.command("codegen")(codegen.codegen)
app.command("diagnose")(diagnose.diagnose)
app.command("identify")(identify.identify)
app.command("validate")(validate.validate)
app.command("excite")(excite.excite)
app.add_typer(robot.app, name="robot")
app.add_typer(path.app, name="path")
app.add_typer(log.app, name="log")


def run() -> None:
    """Entry point: turns errors of the input into one message and exit code 2."""
    from irb2400_ctrl.errors import InputError

    try:
        app()
    except InputError as error:
        print(f"irb2400: {error}", file=sys.stderr)
        sys.exit(2)
    except BrokenPipeError:
        # the reader of our output (head, less) has gone: not an error of ours
        sys.exit(0)


if __name__ == "__main__":
    run()
