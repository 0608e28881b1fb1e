"""`irb2400 diagnose`: what does the model lack that the log shows?"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.logs_in import WHAT, Reader, is_robot, read_logs, say_left_out, stretch_of_one
from irb2400_ctrl.cli.options import (
    BetweenOption,
    ColumnsOption,
    OutOption,
    RobotOption,
    UncertaintyOption,
    ValidateBetweenOption,
    input_file,
    load_arm,
    output_folder,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, writes, wrote

if TYPE_CHECKING:
    from irb2400_ctrl.diagnosis import Diagnosis
    from irb2400_ctrl.measurement import Log
    from irb2400_ctrl.report.elements.page import Page
    from irb2400_ctrl.robot import Robot

LogsArgument = Annotated[
    list[Path],
    typer.Argument(
        metavar="LOG",
        help="Measured logs of one arm (docs/logs.md). Of several, one that cannot be used is "
        "named on stderr and in findings.json and left out.",
    ),
]
ValidateOption = Annotated[
    Path | None,
    typer.Option(metavar="LOG2", help="Another motion of the same arm, for the error after."),
]
ReferenceOption = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="LOG|ROBOT",
        help="The same arm on another day: logs (may be given again), from which it is identified "
        "first, or its robot file. What is found then has changed since.",
    ),
]
CloseLoopOption = Annotated[
    bool,
    typer.Option(
        "--close-loop",
        help="Also generate the controller again (C code in DIR/controller) and track the "
        "log's motion, before and after, on a simulated arm that has what was found.",
    ),
]
ControllerOption = Annotated[
    str,
    typer.Option(
        metavar="NAME", help="Which controller --close-loop makes; an unknown name lists all."
    ),
]


@answers
@writes("robot.toml")
def diagnose(
    logs: LogsArgument,
    out: OutOption,
    validate: ValidateOption = None,
    reference: ReferenceOption = None,
    robot: RobotOption = "irb2400",
    columns: ColumnsOption = None,
    between: BetweenOption = None,
    validate_between: ValidateBetweenOption = None,
    uncertainty: UncertaintyOption = None,
    close_loop: CloseLoopOption = False,
    controller: ControllerOption = "feedforward_pid",
) -> Summary:
    """Find the residual, name the effect behind it, add it to the robot -> findings.json,
    robot.toml, report.html.

    A log that is not what its columns say gets the verdict log_not_understood and exit code 0: that
    is an answer (`irb2400 log check` exits 2). With several logs the exit code is 0 as soon as one
    can be used, and 2 when none can be read."""
    if len(logs) == 1:
        input_file(logs[0], WHAT)
    for path in (validate, *(reference or [])):
        if path is not None and not is_robot(path):
            input_file(path, WHAT)
    stretch_of_one(validate, validate_between)
    output_folder(out)

    from irb2400_ctrl.report.pages.diagnosis_page import diagnosis_page, lines

    robot = _robot_of(reference or [], robot)
    arm = load_arm(robot, uncertainty)
    if close_loop:
        _check_controller(controller, arm, out)
    reader = Reader(columns, arm.joint_names, between)
    unseen = Reader(columns, arm.joint_names, validate_between)
    with step(f"reading {logs[0].name if len(logs) == 1 else f'{len(logs)} logs'}") as say:
        read = read_logs(logs, reader, say)
        other = None if validate is None else unseen.read(validate, say)
    with step("comparing log and model"):
        result = _diagnosed(arm, read.logs, other, reference or [], columns)
        result = replace(result, left_out=(*read.left_out, *result.left_out))
    say_left_out(result.left_out)
    title = f"Diagnosis of {_name(logs, read.logs)}"
    page = diagnosis_page(result, title, read.logs[0], robot)
    page.provenance(provenance(arm))
    text = [*lines(result), f"prior of the robot file: {_prior(arm)}"]
    written = ["findings.json", "robot.toml", "report.html"]
    if close_loop and result.log_problem is None:
        with step("closing the loop"):
            text += _close_loop(result, read.logs[0], controller, page, out)
        written += ["closed_loop.json", "controller"]
    with step("writing the report"):
        result.write(out)
        page.write(out / "report.html")
    print("\n".join(text))
    return wrote(result.to_json(), [out / name for name in written])


def _robot_of(reference: list[Path], robot: str) -> str:
    """The robot that logs are read for and held against: the reference's file, where it is one.

    Raises:
        InputError: a robot file among several references.
    """
    from irb2400_ctrl.errors import InputError

    robots = [path for path in reference if is_robot(path)]
    if robots and len(reference) > 1:
        raise InputError(
            f"--reference: found {len(reference)} with the robot file {robots[0]} among them; "
            "expected one robot file, or logs"
        )
    return str(robots[0]) if robots else robot


def _diagnosed(
    arm: Robot,
    logs: list[Log],
    validation: Log | None,
    reference: list[Path],
    columns: Path | None,
) -> Diagnosis:
    """Against the robot file, which may be the reference's, or against logs of the arm."""
    from irb2400_ctrl.diagnosis import diagnose as run
    from irb2400_ctrl.identification import diagnose_change

    if not reference:
        return run(arm, logs, validation)
    if is_robot(reference[0]):
        return diagnose_change(arm, logs, arm, validation)
    before = read_logs(reference, Reader(columns, arm.joint_names))
    say_left_out(before.left_out)
    return diagnose_change(arm, logs, before.logs, validation)


def _check_controller(controller: str, arm: Robot, out: Path) -> None:
    """What is wrong with its name or its folder is to be said before the long work."""
    from irb2400_ctrl.codegen.provenance import check_folder
    from irb2400_ctrl.controllers import controller as make_controller

    check_folder(out / "controller", make_controller(controller, arm).name)


def _prior(arm: Robot) -> str:
    identified = arm.identified is not None
    return "the covariance of its identification" if identified else arm.uncertainty.says()


def _name(paths: list[Path], logs: list[Log]) -> str:
    return Path(logs[0].name).name if len(paths) == 1 else f"{len(paths)} logs"


def _close_loop(result: Diagnosis, log: Log, controller: str, page: Page, out: Path) -> list[str]:
    """Make the controller again from the diagnosed robot, move as the log did; lines to print."""
    from irb2400_ctrl.codegen import export_package
    from irb2400_ctrl.controllers import controller as make_controller
    from irb2400_ctrl.controllers import guarded
    from irb2400_ctrl.files import write_json
    from irb2400_ctrl.measurement import recorded_motion
    from irb2400_ctrl.report.pages.closed_loop_section import add_closed_loop, closed_loop_lines
    from irb2400_ctrl.simulation.close_the_loop import close_loop

    robot = result.robot
    export_package(guarded(make_controller(controller, robot), robot), out / "controller")
    loop = close_loop(result.given, result.robot, recorded_motion(log), controller=controller)
    write_json(out / "closed_loop.json", loop.summary())
    add_closed_loop(page, result, loop)
    head = f"closed loop: {controller} along the log's motion, on an arm that has what was found"
    return [head, *(f"  {line}" for line in closed_loop_lines(loop))]
