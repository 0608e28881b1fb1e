"""`irb2400 plan`: a toolpath becomes a timed joint trajectory."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.options import OutOption, RobotOption, input_file, output_folder
from irb2400_ctrl.cli.progress import step

if TYPE_CHECKING:
    from irb2400_ctrl.planners import Plan
    from irb2400_ctrl.robot import Robot

PathArgument = Annotated[Path, typer.Argument(metavar="PATH", help="Toolpath: CSV or APT/CLDATA.")]
RateOption = Annotated[
    float, typer.Option(help="Samples per second of the trajectory.", min=10, max=10000)
]
FreeOption = Annotated[
    bool,
    typer.Option(
        "--free-tool-rotation/--fixed",
        help="Turn the tool freely about its own axis, or hold it.",
    ),
]
ShareOption = Annotated[
    float,
    typer.Option(
        help="Share of the torque limits the plan may use; the rest is the controller's.",
        min=0.1,
    ),
]
ToleranceOption = Annotated[
    float, typer.Option(help="How far corners of the path may be cut.", min=1e-4)
]
AxisToleranceOption = Annotated[
    float,
    typer.Option(help="How far the tool may tilt to pass the wrist singularity.", min=0.0),
]
TorqueRateOption = Annotated[
    float | None,
    typer.Option(
        help="Limit of the change of the torque, in torque limits per second [1/s].",
        min=1e-3,
        show_default="no limit",
    ),
]
JerkOption = Annotated[
    float | None,
    typer.Option(
        "--jerk-deg-s3",
        "--jerk",
        help="Limit of the joints' jerk [deg/s3].",
        min=1e-3,
        show_default="no limit",
    ),
]
RapidOption = Annotated[
    bool, typer.Option("--rapid", help="Also write the motion as a RAPID module, program.mod.")
]


def plan(
    path: PathArgument,
    out: OutOption,
    robot: RobotOption = "irb2400",
    rate: RateOption = 250.0,
    free_tool_rotation: FreeOption = True,
    torque_share: ShareOption = 1.0,
    tolerance_mm: ToleranceOption = 0.05,
    axis_tolerance_deg: AxisToleranceOption = 0.1,
    torque_rate: TorqueRateOption = None,
    jerk_deg_s3: JerkOption = None,
    rapid: RapidOption = False,
) -> None:
    """Plan a toolpath: branch, tool rotation, torque-limited timing -> trajectory.csv, plan.json,
    figures."""
    input_file(path, "a toolpath (CSV or APT/CLDATA)")
    output_folder(out)

    from irb2400_ctrl.planners import MotionLimits, plan_path, read_path
    from irb2400_ctrl.robot import load_robot

    arm = load_robot(robot)
    toolpath = read_path(path)
    limits = MotionLimits.of(arm)
    limits = replace(limits, tau_max=torque_share * limits.tau_max)
    task = f"planning {len(toolpath):,} points"
    with step(task) as say:
        planned = plan_path(
            arm,
            toolpath,
            rate=rate,
            free_tool_rotation=free_tool_rotation,
            tolerance=1e-3 * tolerance_mm,
            axis_tolerance=math.radians(axis_tolerance_deg),
            limits=limits,
            torque_rate=None if torque_rate is None else torque_rate * arm.tau_max,
            jerk=None if jerk_deg_s3 is None else math.radians(jerk_deg_s3),
            progress=lambda stage: say(f"{task}: {stage}"),
        )
        say(f"{task}: writing")
        written = _write(planned, arm, out, rapid)
    print(f"{path.name}: {len(toolpath)} points, {planned.summary()['duration_s']:.2f} s")
    _print_summary(planned)
    print(f"written to {out}: {', '.join(written)}")


def _write(planned: Plan, arm: Robot, out: Path, rapid: bool) -> list[str]:
    """The files, and their names."""
    from irb2400_ctrl.report.plan_figures import save_figures

    planned.write(out)
    save_figures(planned, out)
    written = ["trajectory.csv", "plan.json", "torque.png", "margins.png", "joints.png"]
    if rapid:
        from irb2400_ctrl.model import Model
        from irb2400_ctrl.planners.programs.rapid.rapid_program import rapid_program

        rapid_program(Model(arm), planned.trajectory).save(out / "program.mod")
        written.append("program.mod")
    return written


def _print_summary(planned: Plan) -> None:
    s = planned.summary()
    margin = s["singularity_margin"]
    print(
        f"smallest margins: wrist {margin['wrist']:.3f}, shoulder {margin['shoulder']:.3f} m, "
        f"elbow {margin['elbow']:.3f} m"
    )
    held = "; the torque bound holds at every instant by construction" if s["guaranteed"] else ""
    print(
        f"torque at most {100 * s['max_torque_ratio']:.1f} % of its limit, speed "
        f"{100 * s['max_velocity_ratio']:.1f} %{held}"
    )
    if "duration_without_rates_s" in s:
        longer = planned.duration - s["duration_without_rates_s"]
        print(f"{longer:.2f} s longer than without limits of the rates")
