"""`irb2400 excite`: the motion that tells look-alike effects apart."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.options import OutOption, RobotOption, load_arm, motions_named, output_folder
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, writes, wrote


@answers
@writes("trajectory.csv")
def excite(
    group: Annotated[
        str,
        typer.Option(
            "--for",
            metavar="GROUP",
            help="Ambiguity group, or an effect of it, as a report names it; or identify.",
            autocompletion=motions_named,
        ),
    ],
    out: OutOption,
    robot: RobotOption = "irb2400",
    seconds: Annotated[float, typer.Option(help="Duration of the motion, 10 to 600 s.")] = 40.0,
    joint: Annotated[
        int | None, typer.Option(help="Only for effects on this joint; default all at once.")
    ] = None,
) -> Summary:
    """Plan the motion that separates look-alike effects, or the motions to identify an arm by ->
    trajectory.csv, excitation.mod (RAPID), .json, report.html; for identify friction_runs.csv."""
    if group.strip().lower() == "identify":
        return _for_identify(robot, seconds, joint, out)
    from irb2400_ctrl.excitation.groups import group_called

    arm = load_arm(robot)  # brings the user's own effects along
    group_called(group)  # a wrong name is said before anything is written
    output_folder(out)

    from irb2400_ctrl.excitation import excite as run
    from irb2400_ctrl.report.pages.excitation_page import excitation_page

    with step("preparing") as progress:
        found = run(arm, group, seconds=seconds, joint=joint, progress=progress)
        progress("writing")
        page = excitation_page(found)
        page.provenance(provenance(arm))
        paths = [*found.write(out), page.write(out / "report.html")]
    print("\n".join(found.lines()))
    return wrote(found.summary(), paths)


def _for_identify(robot: str, seconds: float, joint: int | None, out: Path) -> Summary:
    from irb2400_ctrl.errors import InputError

    if joint is not None:
        raise InputError("--for identify: found --joint, expected none: an arm is identified whole")
    arm = load_arm(robot)
    output_folder(out)

    from irb2400_ctrl.excitation import excite_identification
    from irb2400_ctrl.report.pages.identification_motion_page import identification_motion_page

    with step("preparing") as progress:
        found = excite_identification(arm, seconds=seconds, progress=progress)
        progress("writing")
        page = identification_motion_page(found, robot)
        page.provenance(provenance(arm))
        paths = [*found.write(out), page.write(out / "report.html")]
    print("\n".join(found.lines(robot)))
    return wrote(found.summary(), paths)
