"""`irb2400 simulate`: a trajectory in closed loop on a plant."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.options import (
    OutOption,
    RobotOption,
    controllers_named,
    input_file,
    load_arm,
    output_folder,
    robots_named,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers


@answers
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
) -> Summary:
    """Track a trajectory with a controller (1 kHz, generated C) -> log.csv, simulation.json,
    report.html."""
    input_file(trajectory, "a trajectory (CSV)")
    output_folder(out)

    from irb2400_ctrl.report.pages.simulation_page import simulation_page
    from irb2400_ctrl.simulation import load_trajectory
    from irb2400_ctrl.simulation import simulate as run
    from irb2400_ctrl.simulation.bounds_reached import in_words

    arm = load_arm(robot)
    motion = load_trajectory(trajectory)
    with step(f"simulating {controller}"):
        simulation = run(arm, motion, controller, plant=None if plant is None else load_arm(plant))
        simulation.write(out)
        page = simulation_page(simulation, controller)
        page.provenance(provenance(arm, seed=simulation.seed))
        page.write(out / "report.html")
    s = simulation.summary()
    print(f"{controller}: {s['duration_s']:.2f} s simulated")
    print(
        f"TCP error {s['tcp_error_mm']['rms']:.3f} mm rms, {s['tcp_error_mm']['max']:.3f} mm at "
        "most"
    )
    for line in in_words(s["bounds_reached"]):
        print(line)
    written = [out / name for name in ("log.csv", "simulation.json", "report.html")]
    print(f"written: {', '.join(map(str, written))}")
    return Summary(s, written)
