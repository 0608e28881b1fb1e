"""`irb2400 plan`: a toolpath becomes a timed joint trajectory."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.options import (
    TOOLPATH,
    CellOption,
    FreeOption,
    OutOption,
    RobotOption,
    RotaryOption,
    ToolOption,
    UnitsOption,
    WorkFrameOption,
    WorkOffsetOption,
    input_file,
    interpolations_named,
    load_arm,
    output_folder,
)
from irb2400_ctrl.cli.planning.cutting import CuttingForceOption, StiffnessOption, cutting_load
from irb2400_ctrl.cli.planning.placing import PositionerOption, doubts, placed
from irb2400_ctrl.cli.planning.plan_program import (
    Job,
    held,
    link_options,
    plan_all,
    plan_parts,
    print_clearance,
    print_deviation,
    print_external,
    print_feed,
    report,
    used,
)
from irb2400_ctrl.cli.planning.rapid_out import (
    RapidIoOption,
    RapidOption,
    RapidSetOption,
    rapid_options,
    write_plan_module,
)
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, writes, wrote
from irb2400_ctrl.errors import UnreachableError

LEAST_TOLD = 0.005
"""cost of limited rates [s] below which nothing is said"""

if TYPE_CHECKING:
    from irb2400_ctrl.planners import CamProgram, Plan
    from irb2400_ctrl.planners.plan_options import PlanOptions
    from irb2400_ctrl.robot import Robot

PathArgument = Annotated[
    Path,
    typer.Argument(
        metavar="PATH",
        help="Toolpath: CSV, APT/CLDATA (NX CLSF, Creo NCL, CATIA), G-code or Heidenhain's .h.",
    ),
]
OperationOption = Annotated[
    str | None,
    typer.Option(
        "--operation",
        metavar="NAME|NUMBER",
        help="Plan this operation only; else all of them, as one motion.",
        show_default="all",
    ),
]
SpindleOption = Annotated[
    float | None,
    typer.Option(
        "--spindle-rpm", help="Spindle speed for feeds per revolution where the file states none."
    ),
]
RateOption = Annotated[
    float, typer.Option(help="Samples per second of the trajectory.", min=10, max=10000)
]
ShareOption = Annotated[
    float,
    typer.Option(
        help="Share of the torque limits the plan may use, 0.9 for 90 %; the rest is the "
        "controller's.",
        min=0.1,
        max=1.0,
    ),
]
ToleranceOption = Annotated[
    float,
    typer.Option(
        help="How far corners of the path may be cut (max_tcp_deviation_mm bounds all).", min=1e-4
    ),
]
AxisToleranceOption = Annotated[
    float,
    typer.Option(help="How far the tool may turn to pass the wrist singularity.", min=0.0),
]
TorqueRateOption = Annotated[
    float | None,
    typer.Option(
        help="Limit of the change of the torque, in torque limits per second [1/s].",
        min=1e-3,
        show_default="what the rows can follow",
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
LinksOption = Annotated[
    bool | None,
    typer.Option(
        "--links/--no-links",
        help="Plan the way from --start to the part, between operations, and back.",
        show_default="with several operations",
    ),
]
ClearanceOption = Annotated[
    float | None,
    typer.Option(
        "--clearance",
        metavar="MM",
        help="Height of the moves between operations above the highest cut.",
        show_default="50",
    ),
]
ApproachOption = Annotated[
    float | None,
    typer.Option(
        "--approach",
        metavar="MM",
        help="Last part of the way down along the tool axis, driven at the feed of the first cut.",
        show_default="10",
    ),
]
StartOption = Annotated[
    str | None,
    typer.Option(
        "--start",
        metavar="Q1,…,Q6",
        help="Joint angles to come from and to return to [deg].",
        show_default="all zero",
    ),
]
InterpolationOption = Annotated[
    str,
    typer.Option(
        help="How the controller reads the rows: cubic (through angles and speeds) or linear.",
        metavar="cubic|linear",
        autocompletion=interpolations_named,
    ),
]

MapOption = Annotated[
    bool,
    typer.Option(
        "--map", help="What other tool rotations would bring: rotation_map.json, and in the report."
    ),
]


@answers
@writes("trajectory.csv")
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
    interpolation: InterpolationOption = "cubic",
    rapid: RapidOption = False,
    rapid_set: RapidSetOption = None,
    rapid_io: RapidIoOption = None,
    operation: OperationOption = None,
    work_frame: WorkFrameOption = None,
    cell: CellOption = None,
    tool: ToolOption = None,
    positioner: PositionerOption = None,
    units: UnitsOption = None,
    rotary: RotaryOption = None,
    work_offset: WorkOffsetOption = None,
    spindle_rpm: SpindleOption = None,
    links: LinksOption = None,
    clearance: ClearanceOption = None,
    approach: ApproachOption = None,
    start: StartOption = None,
    cutting_force: CuttingForceOption = None,
    joint_stiffness: StiffnessOption = None,
    rotation_map: MapOption = False,
) -> Summary:
    """Plan a toolpath: branch, tool rotation, torque-limited timing -> trajectory.csv, plan.json,
    report.html."""
    from irb2400_ctrl.planners.plan_options import PlanOptions

    input_file(path, TOOLPATH)
    program = _read(path, operation, units, rotary, spindle_rpm, work_offset)
    output_folder(out)
    arm = load_arm(robot)
    pose, around, frame = placed(work_frame, cell, positioner)
    options = PlanOptions(
        rate=rate,
        free_tool_rotation=free_tool_rotation,
        work_frame=pose,
        cell=around,
        tool=tool,
        tolerance=1e-3 * tolerance_mm,
        axis_tolerance=math.radians(axis_tolerance_deg),
        torque_share=torque_share,
        load=cutting_load(arm, cutting_force, joint_stiffness, frame),
        interpolation=interpolation,
        rotation_map=rotation_map,
        torque_rate=None if torque_rate is None else torque_rate * arm.tau_max,
        jerk=None if jerk_deg_s3 is None else math.radians(jerk_deg_s3),
    )
    _say_assumed(arm, program, options)
    chosen = link_options(arm, len(program.operations), links, clearance, approach, start)
    job = Job(arm, program, chosen, options, out, rapid_options(rapid, rapid_set, rapid_io))
    return plan_all(job) if _in_parts(job) else _plan_one(job)


def _in_parts(job: Job) -> bool:
    """Whether the program is more than one motion from a first to a last way-point."""
    from irb2400_ctrl.planners.linking.waits import waits

    operations = job.program.operations
    return job.links.ends or len(operations) > 1 or any(map(waits, operations))


def _read(
    path: Path,
    operation: str | None,
    units: str | None,
    rotary: str | None,
    spindle_rpm: float | None,
    offsets: list[str] | None,
) -> CamProgram:
    """The program of a file, with one operation alone where that is asked for."""
    from irb2400_ctrl.planners import read_program

    program = read_program(
        path, units=units, rotary=rotary, spindle_rpm=spindle_rpm, work_offsets=offsets or ()
    )
    if operation is None:
        return program
    return replace(program, operations=(program.operation(operation),))


def _say_assumed(arm: Robot, program: CamProgram, options: PlanOptions) -> None:
    """What the file leaves open, which operations take the robot file's tool because the cell does
    not have theirs, and whether the part is meant to be where it is."""
    for note in program.of_kind("assumed"):
        print(f"assumed, {note}")
    cell = options.cell
    for question in doubts(arm, program, options):
        print(f"is this meant? {question}")
    if cell is None or options.tool is not None:
        return
    for operation in program.operations:
        asked = operation.tool
        if cell.tool_of(asked.number, asked.name) is None:
            named = " ".join(str(word) for word in (asked.number, asked.name) if word) or "stated"
            print(
                f"assumed, operation {operation.number}: no tool {named} in the cell: the robot "
                "file's tool"
            )


def _plan_one(job: Job) -> Summary:
    """The only operation, into the folder itself; in parts where axes have to be unwound."""
    from irb2400_ctrl.planners.plan_path import plan_asked

    operation = job.program.operation()
    toolpath = operation.path
    options = job.options.for_operation(operation, job.arm)
    task = f"planning {len(toolpath):,} points"
    with step(task) as say:
        told = replace(options, progress=lambda stage: say(f"{task}: {stage}"))
        try:
            planned = plan_asked(job.arm, toolpath, told)
        except UnreachableError as error:
            say(f"{task}: unwinding")
            return plan_parts(job, error)
        say(f"{task}: writing")
        planned.write(job.out)
        page = report(planned, job.out, job.arm, f"Plan of {job.program.name}", options)
        written = ["trajectory.csv", "plan.json", page]
        if planned.rotation_map is not None:
            written.append("rotation_map.json")
        if job.rapid is not None:
            written += write_plan_module(planned, operation, job.rapid, options.frame, job.out)
    print(f"{job.program.name}: {len(toolpath)} points, {planned.summary()['duration_s']:.2f} s")
    _print_summary(planned, options.tolerance)
    paths = [job.out / name for name in written]
    return wrote(planned.summary(), paths)


def _print_summary(planned: Plan, tolerance: float) -> None:
    s = planned.summary()
    print_deviation(s, tolerance)
    margin = s["singularity_margin"]
    print(
        f"smallest singularity margins: wrist {margin['wrist']:.3f}, "
        f"shoulder {margin['shoulder']:.3f} m, elbow {margin['elbow']:.3f} m"
    )
    print_clearance(s["clearance_mm"])
    if planned.deflection is not None:
        given = planned.deflection
        print(
            f"the tip gives way by {given['largest_mm']:.3f} mm at most, at "
            f"{given['at_mm']:.0f} mm of the way (joint stiffness: {given['stiffness_from']})"
        )
    print(f"{used(s)}{held(s)}")
    print_external(s["external_axes"])
    print_feed(s["feed"])
    if "rates_note" in s:
        print(s["rates_note"])
    if "duration_without_rates_s" in s:
        # that of the jumping law is a bound of its cells: a hair above what can be
        longer = max(planned.duration - s["duration_without_rates_s"], 0.0)
        if longer >= LEAST_TOLD:
            print(f"{longer:.2f} s longer than without limits of the rates")
