"""`irb2400 identify`: a robot file that is true, from sound logs of the arm."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
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
from irb2400_ctrl.cli.summary import Summary, answers

LogsArgument = Annotated[
    list[Path], typer.Argument(metavar="LOG...", help="Logs of the sound arm (.csv, .csv.gz).")
]
ValidateOption = Annotated[
    list[Path] | None,
    typer.Option(metavar="LOG", help="Another motion, for the error only; may be given again."),
]


@answers
def identify(
    logs: LogsArgument,
    out: OutOption,
    robot: RobotOption = "irb2400",
    validate: ValidateOption = None,
    columns: ColumnsOption = None,
    uncertainty: UncertaintyOption = None,
) -> Summary:
    """Fit bodies, friction, offsets and rotors to logs -> robot.toml, identification.json,
    report.html."""
    others = validate or []
    for path in (*logs, *others):
        input_file(path, "a log (.csv or .csv.gz)")
    output_folder(out)

    from irb2400_ctrl.identification import identify as run
    from irb2400_ctrl.measurement import read_log
    from irb2400_ctrl.report.identification_report import identification_page, lines

    arm = load_arm(robot, uncertainty)
    with step("reading the logs"):
        seen = [read_log(path, columns=columns, names=arm.joint_names) for path in logs]
        unseen = [read_log(path, columns=columns, names=arm.joint_names) for path in others]
    with step("fitting the arm to the logs"):
        result = run(arm, seen, validation=unseen)
    with step("writing the report"):
        result.write(out)
        page = identification_page(result, seen)
        page.provenance(provenance(arm))
        page.write(out / "report.html")
    print("\n".join(lines(result)))
    print(f"prior of the robot file: {arm.uncertainty.says()}")
    names = ("robot.toml", "identification.json", "covariance.json", "report.html")
    print(f"written: {', '.join(str(out / name) for name in names)}")
    return Summary(result.to_json())
