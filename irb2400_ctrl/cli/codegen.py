"""`irb2400 codegen`: a controller becomes a self-contained C package."""

from __future__ import annotations

import json
import math
import sys
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from irb2400_ctrl.cli.options import (
    GuardedOption,
    OutOption,
    RobotOption,
    controllers_named,
    load_arm,
    output_folder,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, wrote

if TYPE_CHECKING:
    from irb2400_ctrl.codegen import Block
    from irb2400_ctrl.robot import Robot

OBSERVER = "momentum_observer"
USUAL_PEAK = 5.0
"""largest sensitivity peak of a loop that has margins: 15 degrees of phase at the least"""


class TargetName(StrEnum):
    """Where the generated C runs."""

    host = "host"
    cortex_m4f = "cortex-m4f"
    cortex_m7 = "cortex-m7"


PackageOption = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help=f"Controller, or {OBSERVER}; an unknown name lists all.",
        autocompletion=lambda: [*controllers_named(), OBSERVER],
    ),
]


@answers
def codegen(
    out: OutOption,
    controller: PackageOption,
    target: Annotated[
        TargetName, typer.Option(help="Processor to build and verify for.")
    ] = TargetName.host,
    precision: Annotated[
        Literal["float", "double"] | None,
        typer.Option(help="Floating-point type; default float on cortex-m4f, double elsewhere."),
    ] = None,
    robot: RobotOption = "irb2400",
    sample_time: Annotated[
        float, typer.Option(help="Seconds between two steps.", min=1e-5, max=0.1)
    ] = 0.001,
    optimise: Annotated[
        Literal["cycles", "size"],
        typer.Option(help="What the compiler is asked for on a processor."),
    ] = "cycles",
    name: Annotated[
        str | None,
        typer.Option(help="Prefix of everything in the package, for several in one image."),
    ] = None,
    bandwidth: Annotated[
        float | None, typer.Option(help="Bandwidth [rad/s] of a controller that has one.")
    ] = None,
    damping: Annotated[
        float | None, typer.Option(help="Damping ratio of a controller that has one.")
    ] = None,
    design: Annotated[
        list[str] | None,
        typer.Option(metavar="WISH=VALUE[,VALUE...]", help="Another wish; may be given again."),
    ] = None,
    tables: Annotated[
        bool,
        typer.Option("--tables", help="Payload, friction, effects as parameters: many tools."),
    ] = False,
    guarded: GuardedOption = True,
) -> Summary:
    """Write a controller as one C99 file and one header, build it for the target and verify it
    there; exit 1 where it is not verified."""
    output_folder(out)

    from irb2400_ctrl.codegen import export_package

    stated = {"bandwidth": bandwidth, "damping": damping, "tables": tables or None}
    wishes = _wishes(design or []) | {w: v for w, v in stated.items() if v is not None}
    block = _block(controller, load_arm(robot), sample_time, wishes, guarded)
    with step(f"generating {controller} for {target.value}"):
        verification = export_package(
            block, out, target=target.value, real=precision, optimise=optimise, name=name
        )
    print(verification.table())
    stop = None if verification.passed else typer.Exit(1)
    return wrote(json.loads(verification.to_json()), [out], stop=stop)


def _wishes(given: list[str]) -> dict[str, Any]:
    """`bandwidth=60` or `bandwidth=60,60,60,80,80,80` as numbers."""
    from irb2400_ctrl.errors import InputError

    wishes: dict[str, Any] = {}
    for text in given:
        wish, _, values = text.partition("=")
        try:
            numbers = [float(value) for value in values.split(",")]
        except ValueError:
            raise InputError(
                f"--design {text}: expected WISH=NUMBER or one number per joint, for example "
                "bandwidth=60 or bandwidth=60,60,60,80,80,80"
            ) from None
        if wish in {"name", "robot", "sample_time"}:
            raise InputError(
                f"--design {text}: expected a wish of the controller; {wish} has an option of its "
                f"own, --{wish.replace('_', '-')}"
            )
        wishes[wish] = numbers[0] if len(numbers) == 1 else numbers
    return wishes


def _block(
    name: str, robot: Robot, sample_time: float, wishes: dict[str, Any], with_guards: bool
) -> Block:
    from irb2400_ctrl.controllers import controller, guarded, momentum_observer
    from irb2400_ctrl.controllers.sampling import check_sampled_loop
    from irb2400_ctrl.errors import InputError

    if name != OBSERVER:

        def build(T: float) -> Block:
            return controller(name, robot, sample_time=T, **wishes)

        if name not in controllers_named():
            known = ", ".join([*controllers_named(), OBSERVER])
            raise InputError(f"no controller {name!r}; expected one of {known}")

        remark = check_sampled_loop(robot, build, sample_time)
        if remark:
            print(f"irb2400: {remark}", file=sys.stderr)
        block = build(sample_time)
        _say_margins(robot, block)
        if with_guards:
            _say_blind(robot)
        return guarded(block, robot) if with_guards else block
    unknown = sorted(set(wishes) - {"bandwidth"})
    if unknown:
        raise InputError(f"{OBSERVER}: found {', '.join(unknown)}; it has bandwidth only")
    return momentum_observer(robot, sample_time, **wishes)


def _say_margins(robot: Robot, block: Block) -> None:
    """The worst of the loop, and a remark where they are too small to be called margins."""
    from irb2400_ctrl.controllers.design import over_poses
    from irb2400_ctrl.controllers.sampling import postures

    poses = postures(robot)
    worst = over_poses(robot, block, poses)
    drive = "drive a sample late, speed filtered at 250 Hz"
    print(f"margins of the loop at rest, worst of {len(poses)} postures, {drive}:")
    print(f"  {worst if worst.stable else 'an error grows'}")
    if not worst.stable:
        print(
            "irb2400: an error of this loop grows, no faster than weight makes it that is balanced "
            "a sample late: an arm for guiding by hand; to follow a reference expected a loop "
            "whose errors fade: sample more often, or ask for higher gains",
            file=sys.stderr,
        )
    elif worst.coupled_peak > USUAL_PEAK:
        print(
            f"irb2400: this loop has hardly a margin: its sensitivity peaks at "
            f"{worst.coupled_peak:.3g}, expected at most {USUAL_PEAK:g}; sample more often, or ask "
            "for other gains",
            file=sys.stderr,
        )


def _say_blind(robot: Robot) -> None:
    """Of which joints the guard cannot tell that motion and torque disagree."""
    blind = [
        j.name for j, tau in zip(robot.joints, robot.tau_bound, strict=True) if tau == math.inf
    ]
    if blind:
        print(
            f"irb2400: torque limit of {', '.join(blind)} is unknown: the guard sees no torque "
            "there that its motion does not explain; state limits.torque_Nm, or set "
            "unexplained_limit in the package's table",
            file=sys.stderr,
        )
