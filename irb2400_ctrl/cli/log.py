"""`irb2400 log check`: what a log holds, and whether it can be this robot's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from irb2400_ctrl.cli.logs_in import WHAT, Reader
from irb2400_ctrl.cli.options import (
    BetweenOption,
    ColumnsOption,
    RobotOption,
    input_file,
    load_arm,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers
from irb2400_ctrl.wording import counted

if TYPE_CHECKING:
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.plausibility import LogCheck
    from irb2400_ctrl.robot import Robot

MOST_NAMED = 12
"""columns of a log that are named"""
MOST_SAID = 1e4
"""per cent that are printed"""
UNEVEN = 1e-3
"""[s] scatter of stamps that are said to be used"""

app = typer.Typer(
    help="what a log holds, before anything is made of it",
    no_args_is_help=True,
    rich_markup_mode=None,
)


@app.callback()
def log() -> None:
    """Look at a log before anything is made of it."""


@app.command(short_help="what logs hold, and whether they can be this robot's")
@answers
def check(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG", help="Measured logs.")],
    robot: RobotOption = "irb2400",
    columns: ColumnsOption = None,
    between: BetweenOption = None,
    no_robot: Annotated[
        bool, typer.Option("--no-robot", help="Only what the columns show of themselves.")
    ] = False,
) -> Summary:
    """Say what logs hold and whether they can be this robot's; exit 2 with the reason when one
    cannot."""
    for path in logs:
        input_file(path, WHAT)
    arm = None if no_robot else load_arm(robot)
    reader = Reader(columns, None if arm is None else arm.joint_names, between)
    found = [_checked(path, arm, reader) for path in logs]
    reasons = [stop for _, stop in found if stop is not None]
    if len(found) == 1:
        return Summary(found[0][0], stop=found[0][1])
    print(f"{len(logs)} logs, {len(logs) - len(reasons)} sound")
    return Summary({"logs": [answer for answer, _ in found]}, stop=reasons[0] if reasons else None)


def _checked(
    path: Path, arm: Robot | None, reader: Reader
) -> tuple[dict[str, Any], InputError | None]:
    """What is said of one log, and why it cannot be used."""
    from irb2400_ctrl.errors import InputError
    from irb2400_ctrl.plausibility import check_log

    try:
        with step(f"reading {path.name}") as say:
            found = check_log(arm, reader.read(path, say))
    except InputError as error:
        return {"name": str(path), "sound": False, "error": str(error)}, error
    print("\n".join(lines(found)))
    stop = None
    if found.problem is not None:
        stop = InputError(f"{path}: {found.problem.says}")
    return found.to_json(), stop


def lines(check: LogCheck) -> list[str]:
    """A log check for a terminal."""
    f = check.facts
    base = f.base
    stamps = ""
    if base.rebuilt:
        stamps = "; the time base is rebuilt (even sampling)"
    elif base.scatter > UNEVEN:
        stamps = "; the stamps are used as they are"
    found = [
        f"{check.name}: {counted(f.joints, 'joint')}, {f.samples} samples, {f.duration:.2f} s at "
        f"{f.rate:.5g} Hz; columns {_some(f.channels)}",
        f"jitter {1e3 * round(base.scatter, 9):.3g} ms rms, {100 * base.lost:.3g} % of the samples "
        f"lost; {counted(f.gaps, 'gap')}, longest time between samples {f.longest_gap:.3g} s"
        f"{stamps}",
        f"{'joint':<36}" + " ".join(f"{j + 1:>8}" for j in range(f.joints)),
    ]
    table = f.to_json() | check.to_json()
    for title, key in (
        ("travel [deg]", "travel_deg"),
        ("torque rms [Nm]", "torque_rms_Nm"),
        ("digit of the angle [deg]", "angle_digit_deg"),
        ("digit of the torque [Nm]", "torque_digit_Nm"),
        ("noise of the torque [Nm]", "torque_noise_Nm"),
        ("of it from noise of the angles [Nm]", "torque_from_angle_noise_Nm"),
        ("lag behind the command [ms]", "lag_ms"),
        ("fitted model leaves below 4 Hz [%]", "left_of_torque_percent"),
    ):
        values = table[key]
        if values is not None:
            found.append(f"{title:<36}" + " ".join(f"{_short(v):>8}" for v in values))
    found += [f"note: {remark}" for remark in check.remarks]
    if check.sound:
        against = "" if check.robot is None else f" and fits {check.robot}"
        if check.robot is not None and check.left is None:
            against = f"; not held against {check.robot}"
        elif check.robot is not None and not check.told:
            against = f"; nothing in it tells whether it is of {check.robot}"
        but = "" if check.whole else ", but for the stretch that a note names"
        found.append(f"sound: the log is what its columns say{against}{but}")
    else:
        assert check.problem is not None
        found.append(f"not understood ({check.problem.kind}): {check.problem.says}")
    return found


def _some(channels: Sequence[str]) -> str:
    """The first names; a recorder may write a hundred others."""
    channels = [name for name in channels if name.strip()]
    others = len(channels) - MOST_NAMED
    return ", ".join(channels[:MOST_NAMED]) + (f" and {others} others" if others > 0 else "")


def _short(value: float | None) -> str:
    """A number of the table; a share of a torque that is nothing is beyond it."""
    if value is None:
        return "-"
    if value >= MOST_SAID:
        return f"> {MOST_SAID:.0e}"
    return f"{value:.0f}" if value >= 1e3 else f"{value:.3g}"
