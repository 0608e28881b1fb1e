"""`irb2400 validate`: how true a robot file is on a log."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.options import ColumnsOption, OutOption, input_file, output_folder
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers

RobotArgument = Annotated[
    str, typer.Argument(metavar="ROBOT", help="A robot file (TOML) or a name.")
]
LogsArgument = Annotated[
    list[Path], typer.Argument(metavar="LOG...", help="Measured logs (.csv, .csv.gz).")
]


@answers
def validate(
    robot: RobotArgument,
    logs: LogsArgument,
    out: OutOption,
    columns: ColumnsOption = None,
) -> Summary:
    """Compare modelled and measured torque (Tab. 6, eqs. 75-77; figures 10-12) ->
    validation.json, report.html."""
    for path in logs:
        input_file(path, "a log (.csv or .csv.gz)")
    output_folder(out)

    from irb2400_ctrl.identification import validate as run
    from irb2400_ctrl.measurement import read_log
    from irb2400_ctrl.report.validation_report import lines, validation_page
    from irb2400_ctrl.robot import load_robot

    arm = load_robot(robot)
    with step("comparing model and log"):
        read = [read_log(path, columns=columns, names=arm.joint_names) for path in logs]
        result = run(arm, read)
        result.write(out)
        validation_page(result).write(out / "report.html")
    print("\n".join(lines(result)))
    print(f"written: {out / 'validation.json'}, {out / 'report.html'}")
    return Summary(result.to_json())
