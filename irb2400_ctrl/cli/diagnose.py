"""`irb2400 diagnose`: what does the model lack that the log shows?"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.options import (
    ColumnsOption,
    OutOption,
    RobotOption,
    UncertaintyOption,
    input_file,
    load_arm,
    output_folder,
)
from irb2400_ctrl.cli.progress import step

if TYPE_CHECKING:
    from irb2400_ctrl.diagnosis import Diagnosis
    from irb2400_ctrl.measurement import Log
    from irb2400_ctrl.report.page import Page

LogArgument = Annotated[Path, typer.Argument(metavar="LOG", help="Measured log (docs/logs.md).")]
ValidateOption = Annotated[
    Path | None,
    typer.Option(metavar="LOG2", help="Another motion of the same arm, for the error after."),
]
ReferenceOption = Annotated[
    Path | None,
    typer.Option(
        metavar="LOG3",
        help="Log of the same arm when it was sound: LOG is judged against the mass data and "
        "friction that it shows, instead of the data sheet's.",
    ),
]
CloseLoopOption = Annotated[
    bool,
    typer.Option(
        "--close-loop",
        help="Also generate the controller again (C code in DIR/controller) and track the "
        "log's motion, before and "
        "after, on a simulated arm that has what was found.",
    ),
]
ControllerOption = Annotated[
    str,
    typer.Option(
        metavar="NAME", help="Which controller --close-loop makes; an unknown name lists all."
    ),
]


def diagnose(
    log: LogArgument,
    out: OutOption,
    validate: ValidateOption = None,
    reference: ReferenceOption = None,
    robot: RobotOption = "irb2400",
    columns: ColumnsOption = None,
    uncertainty: UncertaintyOption = None,
    close_loop: CloseLoopOption = False,
    controller: ControllerOption = "feedforward_pid",
) -> None:
    """Find the residual, name the effect behind it, add it to the robot -> findings.json,
    robot.toml, report.html.

    A log that is not what its columns say gets the verdict log_not_understood and exit code 0: that
    is an answer (`irb2400 log check` exits 2)."""
    for path in (log, validate, reference):
        if path is not None:
            input_file(path, "a log (CSV, MAT, Parquet or ROS 2 bag)")
    output_folder(out)

    from irb2400_ctrl.diagnosis import diagnose as run
    from irb2400_ctrl.measurement import read_log
    from irb2400_ctrl.report.diagnosis_report import diagnosis_page, lines

    arm = load_arm(robot, uncertainty)
    if close_loop:
        from irb2400_ctrl.controllers import controller as make_controller

        make_controller(controller, arm)  # a wrong name is to be said before the long work
    with step(f"reading {log.name}"):
        measured = read_log(log, columns=columns, names=arm.joint_names)
        others = [
            None if path is None else read_log(path, columns=columns, names=arm.joint_names)
            for path in (validate, reference)
        ]
    with step("comparing log and model"):
        result = run(arm, measured, validation=others[0], reference=others[1])
    page = diagnosis_page(result, title=f"Diagnosis of {log.name}")
    text = [*lines(result), f"prior of the robot file: {arm.uncertainty.says()}"]
    written = ["findings.json", "robot.toml", "report.html"]
    if close_loop and result.log_problem is None:
        with step("closing the loop"):
            text += _close_loop(result, measured, controller, page, out)
        written += ["closed_loop.json", "controller"]
    with step("writing the report"):
        result.write(out)
        page.write(out / "report.html")
    print("\n".join(text))
    print(f"written: {', '.join(str(out / name) for name in written)}")


def _close_loop(result: Diagnosis, log: Log, controller: str, page: Page, out: Path) -> list[str]:
    """Make the controller again from the diagnosed robot, move as the log did; lines to print."""
    import json

    from irb2400_ctrl.codegen import export_package
    from irb2400_ctrl.controllers import controller as make_controller
    from irb2400_ctrl.files import write_atomic
    from irb2400_ctrl.measurement import recorded_motion
    from irb2400_ctrl.report.closed_loop_section import add_closed_loop, closed_loop_lines
    from irb2400_ctrl.simulation.close_the_loop import close_loop

    export_package(make_controller(controller, result.robot), out / "controller")
    loop = close_loop(result.given, result.robot, recorded_motion(log), controller=controller)
    write_atomic(out / "closed_loop.json", json.dumps(loop.summary(), indent=2) + "\n")
    add_closed_loop(page, result, loop)
    return closed_loop_lines(loop)
