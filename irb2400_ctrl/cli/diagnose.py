"""`irb2400 diagnose`: what does the model lack that the log shows?"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.options import OutOption, RobotOption, input_file, load_arm, output_folder
from irb2400_ctrl.cli.progress import step


def diagnose(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Measured log (.csv or .csv.gz).")],
    out: OutOption,
    validate: Annotated[
        Path | None,
        typer.Option(metavar="LOG2", help="Another motion of the same arm, for the error after."),
    ] = None,
    reference: Annotated[
        Path | None,
        typer.Option(
            metavar="LOG3", help="Log of the arm known to be sound: gives the noise model."
        ),
    ] = None,
    robot: RobotOption = "irb2400",
    close_loop: Annotated[
        bool,
        typer.Option(
            "--close-loop",
            help="Also generate the controller again (C code in DIR/controller) and track the "
            "log's motion, before and "
            "after, on a simulated arm that has what was found.",
        ),
    ] = False,
    controller: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="Which controller --close-loop makes; an unknown name lists all."
        ),
    ] = "feedforward_pid",
) -> None:
    """Find the residual, name the effect behind it, add it to the robot -> findings.json,
    robot.toml, report.html."""
    for path in (log, validate, reference):
        if path is not None:
            input_file(path, "a log (.csv or .csv.gz)")
    output_folder(out)

    import json

    from irb2400_ctrl.diagnosis import diagnose as run
    from irb2400_ctrl.files import write_atomic
    from irb2400_ctrl.measurement import read_log
    from irb2400_ctrl.report.diagnosis_report import diagnosis_page, lines

    arm = load_arm(robot)
    if close_loop:
        from irb2400_ctrl.controllers import controller as make_controller

        make_controller(controller, arm)  # a wrong name is to be said before the long work
    with step(f"reading {log.name}"):
        logs = [None if path is None else read_log(path) for path in (log, validate, reference)]
    assert logs[0] is not None
    with step("comparing log and model"):
        result = run(arm, logs[0], validation=logs[1], reference=logs[2])
    page = diagnosis_page(result, title=f"Diagnosis of {log.name}")
    text = lines(result)
    if close_loop:
        with step("closing the loop"):
            from irb2400_ctrl.codegen import export_package
            from irb2400_ctrl.report.closed_loop_section import add_closed_loop, closed_loop_lines
            from irb2400_ctrl.simulation.close_the_loop import close_loop as track
            from irb2400_ctrl.simulation.recorded import recorded_motion

            export_package(make_controller(controller, result.robot), out / "controller")
            loop = track(arm, result.robot, recorded_motion(logs[0]), controller=controller)
            write_atomic(out / "closed_loop.json", json.dumps(loop.summary(), indent=2) + "\n")
            add_closed_loop(page, result, loop)
            text += closed_loop_lines(loop)
    with step("writing the report"):
        result.write(out)
        page.write(out / "report.html")
    print("\n".join(text))
    written = [
        "findings.json",
        "robot.toml",
        "report.html",
        *(("closed_loop.json", "controller") if close_loop else ()),
    ]
    print(f"written: {', '.join(str(out / name) for name in written)}")
