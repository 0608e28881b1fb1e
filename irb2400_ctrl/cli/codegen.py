"""`irb2400 codegen`: a controller becomes a self-contained C package."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from irb2400_ctrl.cli.options import OutOption, RobotOption, output_folder
from irb2400_ctrl.cli.progress import step


class Target(StrEnum):
    """Where the generated C runs."""

    host = "host"
    cortex_m4f = "cortex-m4f"
    cortex_m7 = "cortex-m7"


class Precision(StrEnum):
    """Floating-point type of the generated C."""

    float = "float"
    double = "double"


def codegen(
    out: OutOption,
    controller: Annotated[str, typer.Option(metavar="NAME", help="Controller; an unknown name lists all.")],
    target: Annotated[Target, typer.Option(help="Processor to build and verify for.")] = Target.host,
    precision: Annotated[
        Precision | None, typer.Option(help="float or double; default float on cortex-m4f, double elsewhere.")
    ] = None,
    robot: RobotOption = "irb2400",
    sample_time: Annotated[float, typer.Option(help="Seconds between two steps.", min=1e-5, max=0.1)] = 0.001,
) -> None:
    """Write a controller as one C99 file and one header, build it for the target and verify it there."""
    output_folder(out)

    from irb2400_ctrl.codegen import export_package
    from irb2400_ctrl.controllers import controller as make_controller
    from irb2400_ctrl.robot import load_robot

    block = make_controller(controller, load_robot(robot), sample_time=sample_time)
    real = precision.value if precision else "float" if target is Target.cortex_m4f else "double"
    with step(f"generating {controller} for {target.value}"):
        verification = export_package(block, out, target=target.value, real=real)
    print(verification.table())
    print(f"written: {out}")
