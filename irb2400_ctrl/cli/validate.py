"""`irb2400 validate`: how true a robot file is on a log."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.logs_in import WHAT, Reader, is_robot
from irb2400_ctrl.cli.options import (
    BetweenOption,
    ColumnsOption,
    OutOption,
    RobotOption,
    input_file,
    load_arm,
    output_folder,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, wrote

LogsArgument = Annotated[
    list[Path], typer.Argument(metavar="LOG", help="Measured logs of one arm.")
]


@answers
def validate(
    logs: LogsArgument,
    out: OutOption,
    robot: RobotOption = "irb2400",
    columns: ColumnsOption = None,
    between: BetweenOption = None,
) -> Summary:
    """Compare modelled and measured torque (Tab. 6, eqs. 75-77; figures 10-12) ->
    validation.json, report.html."""
    if is_robot(logs[0]) and len(logs) > 1:
        # the order of 0.2
        robot = str(logs[0])
        logs = logs[1:]
        print(
            f"irb2400: validate ROBOT LOG... goes with 0.3; give the robot by --robot {robot}",
            file=sys.stderr,
        )
    for path in logs:
        input_file(path, WHAT)
    output_folder(out)

    from irb2400_ctrl.identification import validate as run
    from irb2400_ctrl.plausibility import log_problem
    from irb2400_ctrl.report.pages.validation_page import lines, validation_page

    arm = load_arm(robot)
    reader = Reader(columns, arm.joint_names, between)
    with step("comparing model and log") as say:
        seen = [reader.read(path, say) for path in logs]
        problems = [log_problem(arm, log) for log in seen]
        told = ["" if one is None else f"is not understood: {one.says}" for one in problems]
        result = run(arm, seen).with_problems(told)
        result.write(out)
        page = validation_page(result, arm, seen[0])
        page.provenance(provenance(arm))
        page.write(out / "report.html")
    for log in result.logs:
        if log.problem:
            print(f"warning: {log.log} {log.problem}", file=sys.stderr)
    print("\n".join(lines(result)))
    written = [out / "validation.json", out / "report.html"]
    return wrote(result.to_json(), written)
