"""Options of a cutting force and of the joints that give way to it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.errors import InputError

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
    from irb2400_ctrl.robot import Robot

CuttingForceOption = Annotated[
    str | None,
    typer.Option(
        "--cutting-force",
        metavar="N|FX,FY,FZ",
        help="Prefer what gives way least to this force on the tip: its size in any direction, or "
        "components in the CAM file's frame.",
    ),
]
StiffnessOption = Annotated[
    str | None,
    typer.Option(
        "--joint-stiffness",
        metavar="K1,K2,..",
        help="Of each joint [Nm/rad].",
        show_default="the robot file's elastic_joint effects",
    ),
]


def cutting_load(
    arm: Robot, force: str | None, stiffness: str | None, frame: Array | None
) -> CuttingLoad | None:
    """What the two options say; None without a force.

    Args:
        frame: pose of the frame that the force is stated in, in the base, shape (4, 4).

    Raises:
        InputError: no numbers, or a stiffness without a force.
    """
    from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad

    if force is None:
        if stiffness is not None:
            raise InputError(
                "--joint-stiffness: found no --cutting-force, which it is for; expected both"
            )
        return None
    pushed = _numbers("--cutting-force", force)
    stated = None if stiffness is None else _numbers("--joint-stiffness", stiffness)
    return CuttingLoad.of(arm, pushed, stated).turned(frame)


def _numbers(option: str, text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError as error:
        raise InputError(
            f"{option}: found {text!r}, expected numbers with commas between them"
        ) from error
