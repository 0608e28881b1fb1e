"""`irb2400 path show`: what a CAM file holds, and what of it is not understood."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.options import (
    TOOLPATH,
    CellOption,
    RotaryOption,
    ToolOption,
    UnitsOption,
    WorkFrameOption,
    WorkOffsetOption,
    input_file,
)
from irb2400_ctrl.cli.planning import bag
from irb2400_ctrl.cli.summary import Summary, answers
from irb2400_ctrl.errors import InputError

if TYPE_CHECKING:
    from irb2400_ctrl.arrays import Array
    from irb2400_ctrl.cell import Cell
    from irb2400_ctrl.planners import CamProgram, Operation

app = typer.Typer(
    help="look at a CAM file, pass a motion on", no_args_is_help=True, rich_markup_mode=None
)
KINDS = {
    "unknown": "not understood (irb2400 plan refuses the file)",
    "assumed": "assumed",
    "ignored": "left out, moves nothing",
}


@app.callback()
def main() -> None:
    """Look at a CAM file, pass a motion on."""


app.command("bag", short_help="a motion as a ROS 2 bag")(bag.bag)


@app.command(short_help="what a CAM file holds, operation by operation")
@answers
def show(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help="CSV, APT/CLDATA (NX, Creo, CATIA), G-code, Heidenhain's .h."
        ),
    ],
    units: UnitsOption = None,
    rotary: RotaryOption = None,
    work_offset: WorkOffsetOption = None,
    work_frame: WorkFrameOption = None,
    cell: CellOption = None,
    tool: ToolOption = None,
) -> Summary:
    """Print the operations: tool, points, length, feed, extent; what was not understood."""
    input_file(file, TOOLPATH)

    from irb2400_ctrl.planners import read_program

    program = read_program(
        file, units=units, rotary=rotary, work_offsets=work_offset or (), strict=False
    )
    count = len(program.operations)
    operations = "1 operation" if count == 1 else f"{count} operations"
    print(f"{program.name}: {program.dialect}, {operations}")
    placed = _Placed.of(work_frame, cell, tool)
    for operation in program.operations:
        _print_operation(operation)
        for line in placed.lines(operation):
            print(f"   {line}")
    _print_notes(program)
    return Summary(program.summary())


@dataclass(frozen=True)
class _Placed:
    """Where the file's frame stands, and which tools there are."""

    pose: Array | None
    """X_BW, shape (4, 4); None where nobody says"""
    cell: Cell | None
    tool: str | None
    """for all operations"""

    @classmethod
    def of(cls, work_frame: str | None, cell: Path | None, tool: str | None) -> _Placed:
        """From the options.

        Raises:
            InputError: a tool without a cell, or one that the cell does not have.
        """
        from irb2400_ctrl.cell import load_cell
        from irb2400_ctrl.planners.toolpath.work_frame import work_frame as pose_of

        around = None if cell is None else load_cell(cell)
        if tool is not None:
            if around is None:
                raise InputError(
                    "found --tool without --cell; expected the cell file that has the tool"
                )
            around.tool(tool)
        pose = None if around is None else around.work_frame
        return cls(pose if work_frame is None else pose_of(work_frame), around, tool)

    def lines(self, operation: Operation) -> list[str]:
        """What is known beyond the file."""
        found = []
        if self.pose is not None:
            place = 1e3 * operation.path.moved(self.pose).position
            ends = zip("xyz", place.min(axis=0), place.max(axis=0), strict=True)
            extent = ", ".join(f"{axis} {a:.3f} … {b:.3f}" for axis, a, b in ends)
            found.append(f"in the robot base [mm] {extent}")
        if self.cell is not None:
            asked = operation.tool
            name = self.tool or self.cell.tool_of(asked.number, asked.name)
            found.append(f"tool of the cell: {name or 'none of this number or name'}")
        return found


def _print_operation(operation: Operation) -> None:
    s = operation.summary()
    tool = s["tool"]
    number = "" if tool["number"] is None else f" {tool['number']}"
    diameter = "" if tool["diameter_mm"] is None else f", diameter {tool['diameter_mm']:g} mm"
    feed = s["feed_mm_s"]
    ends = [] if feed is None else dict.fromkeys(f"{end:.4g}" for end in feed)
    stated = f"{' … '.join(ends)} mm/s" if ends else "none stated"
    turning = f"{s['spindle_rpm']:.0f} 1/min {s['spindle']}" if s["spindle_rpm"] else "not stated"
    low, high = s["extent_mm"]
    extent = ", ".join(
        f"{axis} {a:.3f} … {b:.3f}" for axis, a, b in zip("xyz", low, high, strict=True)
    )
    print(f"{s['number']}: {s['name']} (lines {s['lines'][0]} to {s['lines'][1]})")
    name = f" {tool['name']}" if tool["name"] else ""
    print(f"   tool{number}{name}{diameter}; spindle {turning}; coolant {s['coolant']}")
    print(
        f"   {s['points']} points, {s['rapid_moves']} rapid; cut {s['cutting_length_mm']:.1f} mm, "
        f"rapid {s['rapid_length_mm']:.1f} mm; feed {stated}"
    )
    print(f"   extent [mm] {extent}")
    if operation.events:
        shown = [f"line {event.line} {event.kind} {event.text}" for event in operation.events[:5]]
        more = "" if len(operation.events) <= 5 else f"; and {len(operation.events) - 5} more"
        print(f"   events: {'; '.join(shown)}{more}")


def _print_notes(program: CamProgram) -> None:
    for kind, title in KINDS.items():
        notes = program.of_kind(kind)
        if notes:
            print(f"{title}:")
        for note in notes:
            print(f"   {note}")
