"""`irb2400 codegen`: a controller becomes a self-contained C package."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, Literal

import typer

from irb2400_ctrl.cli.options import OutOption, RobotOption, load_arm, output_folder
from irb2400_ctrl.cli.progress import step


class TargetName(StrEnum):
    """Where the generated C runs."""

    host = "host"
    cortex_m4f = "cortex-m4f"
    cortex_m7 = "cortex-m7"


def codegen(
    out: OutOption,
    controller: Annotated[
        str, typer.Option(metavar="NAME", help="Controller; an unknown name lists all.")
    ],
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
) -> None:
    """Write a controller as one C99 file and one header, build it for the target and verify it
    there."""
    output_folder(out)

    from irb2400_ctrl.codegen import export_package
    from irb2400_ctrl.controllers import controller as make_controller

    block = make_controller(controller, load_arm(robot), sample_time=sample_time)
    with step(f"generating {controller} for {target.value}"):
        verification = export_package(
            block, out, target=target.value, real=precision, optimise=optimise
        )
    print(verification.table())
    print(f"written: {out}")
