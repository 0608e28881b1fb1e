"""Where the part of `irb2400 plan` stands: its work frame, its cell, its positioner."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from irb2400_ctrl.errors import InputError

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.cell import Cell
    from irb2400_ctrl.planners import CamProgram
    from irb2400_ctrl.planners.plan_options import PlanOptions
    from irb2400_ctrl.robot import Robot

PositionerOption = Annotated[
    str | None,
    typer.Option(
        "--positioner",
        metavar="find|move|TILT,TURN",
        help="Angles of the cell's positioner [deg] for all operations; find: the ones at which "
        "each operation's tool axes are nearest to upright; move: it turns during the cut.",
        show_default="the cell file's",
    ),
]


def placed(
    work_frame: str | None, cell: Path | None, positioner: str | None
) -> tuple[Array | None, Cell | None, Array | None]:
    """The stated work frame, the cell with its work object there, and where the path stands."""
    from irb2400_ctrl.cell import load_cell
    from irb2400_ctrl.planners.toolpath.work_frame import work_frame as pose_of

    pose = None if work_frame is None else pose_of(work_frame)
    if cell is None:
        if positioner is not None:
            raise InputError("--positioner: found no --cell, expected the one with [positioner]")
        return pose, None, pose
    around = load_cell(cell).placed(pose)
    if positioner is not None:
        around = around.on_positioner(_tilt_and_turn(positioner))
    return pose, around, around.work_frame


def doubts(arm: Robot, program: CamProgram, options: PlanOptions) -> list[str]:
    """What to ask of the place of a part: a spindle below it, a path beside it, a mesh with gaps,
    angles in radians, places in metres, a misspelt operation.

    Args:
        arm: whose gravity says what is below.
        program: its points in the frame of the CAM file.
        options: with the frame and the cell.
    """
    from irb2400_ctrl.cell.metres_typed import metres_typed
    from irb2400_ctrl.cell.piece import cell_pieces, open_meshes
    from irb2400_ctrl.cell.radians_typed import radians_typed
    from irb2400_ctrl.planners.clearance.beside_part import beside_part
    from irb2400_ctrl.planners.toolpath.from_below import from_below

    cell = options.cell
    frame = options.frame
    pieces = [] if cell is None else cell_pieces(cell)
    turns = cell is not None and cell.positioner is not None
    found = [
        None if turns else from_below(arm, program, frame),
        beside_part(program, pieces, frame),
        open_meshes(pieces),
        radians_typed(cell, frame),
        metres_typed(cell, frame),
        None if cell is None else _misspelt(program, cell),
    ]
    return [question for question in found if question is not None]


def _misspelt(program: CamProgram, cell: Cell) -> str | None:
    """What to ask of an operation that a rail or a positioner has a place for, and that the program
    calls otherwise; one that is not like any of the program may be another program's."""
    names = {operation.name.casefold(): operation.name for operation in program.operations}
    known = {*names.values(), *(str(operation.number) for operation in program.operations)}
    for what, axes in (("rail", cell.rail), ("positioner", cell.positioner)):
        if axes is None:
            continue
        for name in axes.operations:
            near = difflib.get_close_matches(name.casefold(), names, n=1, cutoff=0.8)
            if near and name not in known and names[near[0]] not in axes.operations:
                return (
                    f"[{what}] has a place for the operation {name}, the program has "
                    f"{names[near[0]]}, which stays at that of all others"
                )
    return None


def _tilt_and_turn(text: str) -> tuple[float, float] | Literal["find", "move"]:
    if text.strip() == "find":
        return "find"
    if text.strip() == "move":
        return "move"
    try:
        tilt, turn = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f"--positioner: found {text!r}, expected find, move, or two angles in "
            "degrees such as 30,0"
        ) from None
    return tilt, turn
