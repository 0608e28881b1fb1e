"""`irb2400 simulate`: a trajectory in closed loop on a plant."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.options import (
    GuardedOption,
    OutOption,
    RobotOption,
    controllers_named,
    input_file,
    load_arm,
    output_folder,
    robots_named,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, writes, wrote

if TYPE_CHECKING:
    from irb2400_ctrl.robot import Robot

SAMPLE_TIME = 0.001
"""of the controller [s]"""


@answers
@writes("log.csv")
def simulate(
    trajectory: Annotated[
        Path, typer.Argument(metavar="TRAJECTORY", help="trajectory.csv of `irb2400 plan`.")
    ],
    out: OutOption,
    controller: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Controller; an unknown name lists all.",
            autocompletion=controllers_named,
        ),
    ],
    robot: RobotOption = "irb2400",
    plant: Annotated[
        str | None,
        typer.Option(
            metavar="ROBOT",
            help="Robot of the plant; the controller's own if absent.",
            autocompletion=robots_named,
        ),
    ] = None,
    guarded: GuardedOption = True,
) -> Summary:
    """Track a trajectory with a controller (1 kHz, the C of `codegen`) -> log.csv, simulation.json,
    report.html."""
    input_file(trajectory, "a trajectory (CSV)")
    output_folder(out)

    from irb2400_ctrl.controllers import controller as make_controller
    from irb2400_ctrl.controllers import guarded as guard
    from irb2400_ctrl.report.pages.simulation_page import simulation_page
    from irb2400_ctrl.simulation import load_trajectory
    from irb2400_ctrl.simulation import simulate as run
    from irb2400_ctrl.simulation.reference_check import planned_for_another

    arm = load_arm(robot)
    motion = load_trajectory(trajectory)
    other = None if plant is None else load_arm(plant)
    block = make_controller(controller, arm, SAMPLE_TIME)
    _say_unstable(controller, arm)
    with step(f"simulating {controller}"):
        simulation = run(arm, motion, guard(block, arm) if guarded else block, plant=other)
        page = simulation_page(simulation, controller)
        page.provenance(provenance(arm, seed=simulation.seed))
        simulation.write(out)
        page.write(out / "report.html")
    if doubt := planned_for_another(arm, motion):
        print(f"irb2400: {trajectory}: {doubt}", file=sys.stderr)
    summary = simulation.summary()
    print("\n".join(_lines(controller, summary)))
    written = [out / name for name in ("log.csv", "simulation.json", "report.html")]
    return wrote(summary, written)


def _say_unstable(controller: str, arm: Robot) -> None:
    """What `codegen` says of the loop of a controller and its own arm; a run shows it, and is not
    refused."""
    from irb2400_ctrl.controllers import controller as make_controller
    from irb2400_ctrl.controllers.sampling import loop_remark

    remark = loop_remark(arm, partial(make_controller, controller, arm), SAMPLE_TIME)
    if remark:
        print(f"irb2400: {remark}", file=sys.stderr)


def _lines(controller: str, summary: dict[str, Any]) -> list[str]:
    """The errors, and every bound that was reached."""
    from irb2400_ctrl.simulation.bounds_reached import in_words

    error = summary["tcp_error_mm"]
    closed = summary["bounds_reached"]["brake_closed_s"]
    followed = []
    if closed is not None:
        followed.append(f"not followed to its end: the brake closes at {closed:.3f} s and stays so")
    return [
        f"{controller}: {summary['duration_s']:.2f} s simulated",
        *followed,
        f"TCP error {error['rms']:.3f} mm rms, {error['max']:.3f} mm at most",
        *in_words(summary["bounds_reached"]),
    ]
