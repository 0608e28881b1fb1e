"""`irb2400 identify`: a robot file that is true, from sound logs of the arm."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.logs_in import WHAT, Reader, stretch_of_one
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
    from irb2400_ctrl.robot import Body

LogsArgument = Annotated[
    list[Path], typer.Argument(metavar="LOG", help="Logs of the sound arm (docs/logs.md).")
]
ValidateOption = Annotated[
    list[Path] | None,
    typer.Option(metavar="LOG", help="Another motion, for the error only; may be given again."),
]
LoadedOption = Annotated[
    list[Path] | None,
    typer.Option(metavar="LOG", help="The arm with a load that was weighed; may be given again."),
]
LoadOption = Annotated[
    str | None,
    typer.Option(metavar="KG,X,Y,Z", help="That load: mass, centre [mm] in the flange's axes."),
]


@answers
@writes("robot.toml")
def identify(
    logs: LogsArgument,
    out: OutOption,
    robot: RobotOption = "irb2400",
    validate: ValidateOption = None,
    loaded: LoadedOption = None,
    load: LoadOption = None,
    columns: ColumnsOption = None,
    between: BetweenOption = None,
    validate_between: ValidateBetweenOption = None,
    uncertainty: UncertaintyOption = None,
) -> Summary:
    """Fit bodies, friction, offsets and rotors to logs -> robot.toml, identification.json,
    report.html."""
    others = validate or []
    heavy = loaded or []
    body = None if load is None else _load(load)
    for path in (*logs, *others, *heavy):
        input_file(path, WHAT)
    stretch_of_one(others, validate_between)
    output_folder(out)

    from irb2400_ctrl.identification import identify as run
    from irb2400_ctrl.model.plausibility import unknown_bodies
    from irb2400_ctrl.report.pages.identification_page import identification_page, lines

    arm = load_arm(robot, uncertainty)
    of_logs = Reader(columns, arm.joint_names, between)
    of_others = Reader(columns, arm.joint_names, validate_between)
    whole = Reader(columns, arm.joint_names)
    with step("reading the logs") as say:
        seen = [of_logs.read(path, say) for path in logs]
        unseen = [of_others.read(path, say) for path in others]
        weighed = [whole.read(path, say) for path in heavy]
    with step("fitting the arm to the logs"):
        result = run(arm, seen, validation=unseen, loaded=weighed, load=body)
    with step("writing the report"):
        result.write(out)
        page = identification_page(result, seen)
        page.provenance(provenance(arm))
        page.write(out / "report.html")
    print("\n".join(lines(result)))
    known = "none of the bodies" if unknown_bodies(arm) else arm.uncertainty.says()
    print(f"prior of the robot file: {known}")
    names = ("robot.toml", "identification.json", "covariance.json", "report.html")
    written = [out / name for name in names]
    return wrote(result.to_json(), written)


def _load(text: str) -> Body:
    """A small body from its mass [kg] and centre [mm]."""
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.robot import Body

    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 4 or not numbers[0] > 0.0:
        raise InputError(
            f"--load: found {text!r}, expected mass [kg] and centre [mm] in the flange's axes, "
            "like 5.02,0,0,80"
        )
    mass, x, y, z = numbers
    centre = (x / 1000.0, y / 1000.0, z / 1000.0)
    return Body(mass_kg=mass, com_m=centre, inertia_kgm2=(0.0,) * 6)
