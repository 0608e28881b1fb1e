"""`irb2400 place`: where to put a part."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.options import (
    TOOLPATH,
    CellOption,
    FreeOption,
    OutOption,
    RobotOption,
    RotaryOption,
    ToolOption,
    UnitsOption,
    WorkOffsetOption,
    input_file,
    load_arm,
    output_folder,
)
from irb2400_ctrl.cli.planning.cutting import CuttingForceOption, StiffnessOption, cutting_load
from irb2400_ctrl.cli.planning.margin_lines import margin_lines, planned_margins
from irb2400_ctrl.cli.planning.on_rail import on_rail
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, answers, wrote
from irb2400_ctrl.errors import InputError

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.cell import Cell
    from irb2400_ctrl.planners import CamProgram
    from irb2400_ctrl.planners.placement import Area, Placement
    from irb2400_ctrl.planners.plan_options import PlanOptions
    from irb2400_ctrl.report import Page
    from irb2400_ctrl.robot import Robot

PartsArgument = Annotated[
    list[Path],
    typer.Argument(metavar="PART", help="Toolpaths of one part, all in its work object's frame."),
]
StartOption = Annotated[
    str | None,
    typer.Option(
        "--work-frame",
        metavar="X,Y,Z,RX,RY,RZ",
        help="Where the part stands now [mm, deg]: the found place is compared with it, and the "
        "part stays tilted as it is there.",
        show_default="the cell's work object, or the base",
    ),
]
AreaOption = Annotated[
    str | None,
    typer.Option(
        "--area",
        metavar="XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX",
        help="Box that the middle of the part stays in [mm].",
        show_default="all that the arm reaches above its foot",
    ),
]
TurnOption = Annotated[
    bool,
    typer.Option("--turn/--no-turn", help="Whether the part may be turned about the vertical."),
]
PlanOption = Annotated[
    bool, typer.Option("--plan", help="Plan both places, into the folders start and found.")
]

RailOption = Annotated[
    bool,
    typer.Option("--rail", help="Leave the part; find where on the cell's rail the arm stands."),
]


@answers
def place(
    parts: PartsArgument,
    out: OutOption,
    robot: RobotOption = "irb2400",
    work_frame: StartOption = None,
    area: AreaOption = None,
    turn: TurnOption = True,
    free_tool_rotation: FreeOption = True,
    cell: CellOption = None,
    tool: ToolOption = None,
    units: UnitsOption = None,
    rotary: RotaryOption = None,
    work_offset: WorkOffsetOption = None,
    cutting_force: CuttingForceOption = None,
    joint_stiffness: StiffnessOption = None,
    plan: PlanOption = False,
    rail: RailOption = False,
) -> Summary:
    """Find the pose of a part that leaves the largest margins -> placement.json,
    report.html."""
    for part in parts:
        input_file(part, TOOLPATH)

    from irb2400_ctrl.planners import read_program
    from irb2400_ctrl.planners.placement import place as find_place
    from irb2400_ctrl.planners.plan_options import PlanOptions
    from irb2400_ctrl.planners.toolpath.work_frame import work_frame as pose_of
    from irb2400_ctrl.report.pages.placement_page import placement_page

    around = _cell_of(cell)
    programs = [
        read_program(part, units=units, rotary=rotary, work_offsets=work_offset or ())
        for part in parts
    ]
    arm = load_arm(robot)
    load = cutting_load(arm, cutting_force, joint_stiffness, None)
    start = None if work_frame is None else pose_of(work_frame)
    output_folder(out)
    if rail:
        standing = None if around is None else around.placed(start)
        return on_rail(arm, programs, standing, free_tool_rotation, tool, load, out)
    box = _area(arm, area, turn)
    with step("looking for a place") as say:
        found = find_place(
            arm,
            programs,
            start=start,
            area=box,
            free_tool_rotation=free_tool_rotation,
            cell=around,
            tool=tool,
            load=load,
            progress=lambda stage: say(f"looking for a place: {stage}"),
        )
    facts = _asked(found, around)
    if plan:
        options = PlanOptions(free_tool_rotation=free_tool_rotation, tool=tool)
        facts["planned"] = _both(found, programs, around, options, out)
    _print(facts)
    return _written(facts, placement_page(found, facts.get("planned"), around), arm, out)


def _asked(found: Placement, cell: Cell | None) -> dict[str, Any]:
    """The content of `placement.json`, after asking whether the start is as it is meant to be."""
    from irb2400_ctrl.cell.metres_typed import metres_typed
    from irb2400_ctrl.cell.radians_typed import radians_typed

    asked = [f"{o} at the start; the two may stand so elsewhere, too" for o in found.overlapping]
    units = [metres_typed(cell, None), radians_typed(cell, found.start.X_BW)]
    for question in [*asked, *(said for said in units if said is not None)]:
        print(f"is this meant? {question}")
    return found.summary()


def _written(facts: dict[str, Any], page: Page, arm: Robot, out: Path) -> Summary:
    from irb2400_ctrl.files import write_json

    page.provenance(provenance(arm))
    written = [
        write_json(out / "placement.json", facts),
        page.write(out / "report.html"),
    ]
    return wrote(facts, written)


def _cell_of(file: Path | None) -> Cell | None:
    from irb2400_ctrl.cell import load_cell
    from irb2400_ctrl.cell.piece import cell_pieces, open_meshes

    if file is None:
        return None
    around = load_cell(file)
    if around.rail_moves:
        raise InputError(
            f"cell {around.name}: found a rail whose carriage moves, which the search of a place "
            "does not follow; expected a place at which it stands (position_mm)"
        )
    if around.positioner is not None:
        raise InputError(
            f"cell {around.name}: found a [positioner], which the search of a place does not turn; "
            "expected a cell without it (plan --positioner find chooses its angles)"
        )
    question = open_meshes(cell_pieces(around))
    if question is not None:
        print(f"is this meant? {question}")
    return around


_INSIDE_FOOT_M = 0.01
"""from the middle of the foot: no arm stands beside that"""


def _area(arm: Robot, text: str | None, turn: bool) -> Area:
    import numpy as np

    from irb2400_ctrl.model import Model
    from irb2400_ctrl.planners.placement import Area

    turns = np.radians([0.0, 90.0, 180.0, 270.0]) if turn else np.zeros(1)
    if text is None:
        found = Area.around(Model(arm), turns)
        return Area(found.low, found.high, turns, turn)
    try:
        values = np.array([float(part) for part in text.split(",")]) / 1e3
    except ValueError:
        values = np.empty(0)
    if values.shape != (6,):
        raise InputError(
            f"--area: found {text!r}, expected XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX in mm, such as "
            "500,-800,200,1200,800,600"
        )
    if 0.0 < np.abs(values).max() < _INSIDE_FOOT_M:
        raise InputError(
            f"--area: found {text!r}, expected mm: a box inside the arm's foot has no place "
            "for a part; it looks like metres"
        )
    return Area(values[:3], values[3:], turns, turn)


def _both(
    found: Placement,
    programs: list[CamProgram],
    cell: Cell | None,
    options: PlanOptions,
    out: Path,
) -> dict[str, Any]:
    """What planning at the start and at the found place gives."""
    places = {"start": found.start.X_BW, "found": found.found.X_BW}
    return {
        name: _planned(found, programs, cell, X, options, out / name) for name, X in places.items()
    }


def _planned(
    found: Placement,
    programs: list[CamProgram],
    cell: Cell | None,
    X_BW: Array,
    options: PlanOptions,
    out: Path,
) -> dict[str, Any]:
    """What planning the operations one by one gives at a place."""
    import numpy as np

    from irb2400_ctrl.model import Model
    from irb2400_ctrl.planners.joint_box import left_in_box
    from irb2400_ctrl.planners.plan_path import plan_asked
    from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES, scales

    load = None if found.load is None else found.load.turned(X_BW)
    around = None if cell is None else cell.placed(X_BW)
    there = replace(options, cell=around, work_frame=X_BW, load=load)
    told: list[dict[str, Any]] = []
    limits: list[float] = []
    for number, operation in enumerate((o for p in programs for o in p.operations), 1):
        try:
            asked = there.for_operation(operation, found.robot)
            plan = plan_asked(found.robot, operation.path, asked)
        except InputError as error:
            return {"refused": f"operation {number}: {error}"}
        plan.write(out / f"{number:02d}")
        told.append(plan.summary())
        limits.append(float(np.degrees(left_in_box(found.robot, plan.trajectory.q).min())))
    margins = [s["singularity_margin"] for s in told]
    clearance = [s["clearance_mm"]["value"] for s in told]
    known = [value for value in clearance if value is not None]
    given = [s["deflection"]["largest_mm"] for s in told if s["deflection"]]
    least = {name: min(m[name] for m in margins) for name in margins[0]}
    sizes = dict(zip(NAMES, scales(Model(found.robot)).tolist(), strict=True))
    return {
        "refused": "",
        "duration_s": sum(s["duration_s"] for s in told),
        "singularity_margin": least,
        "margins": {
            **{name: value / sizes[name] for name, value in least.items()},
            "joint_limits_deg": min(limits),
        },
        "clearance_mm": min(known, default=None),
        "max_torque_ratio": max(s["max_torque_ratio"] for s in told),
        "max_velocity_ratio": max(s["max_velocity_ratio"] for s in told),
        "guaranteed": all(s["guaranteed"] for s in told),
        "deflection_mm": max(given, default=None),
    }


def _print(facts: dict[str, Any]) -> None:
    for name in ("start", "found"):
        seen = facts[name]
        frame = ",".join(f"{v:g}" for v in seen["work_frame"])
        given = seen["deflection_mm"]
        soft = "" if given is None else f"; gives way by {given:.3f} mm"
        print(f"{name}: --work-frame={frame}{soft}")
        wrong = seen["refused"] or seen["continuous"]["refused"]
        if wrong:
            print(f"  cannot be done there: {wrong}")
    for line in margin_lines(facts["start"], facts["found"]):
        print(line)
    print(f"{facts['looked_at']} places looked at")
    for name, told in facts.get("planned", {}).items():
        if told["refused"]:
            print(f"planned at {name}: {told['refused']}")
        else:
            print(
                f"planned at {name}: {told['duration_s']:.2f} s, torque at most "
                f"{100 * told['max_torque_ratio']:.1f} %, speed "
                f"{100 * told['max_velocity_ratio']:.1f} %"
            )
            print(f"  {planned_margins(told, facts[name]['continuous'])}")
