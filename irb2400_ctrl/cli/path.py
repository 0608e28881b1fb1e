"""`irb2400 path show`: what a CAM file holds, and what of it is not understood."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irb2400_ctrl.cli.options import input_file
from irb2400_ctrl.cli.summary import Summary, answers

if TYPE_CHECKING:
    from irb2400_ctrl.planners import CamProgram, Operation

app = typer.Typer(
    help="Look at a CAM file or a tool path.", no_args_is_help=True, rich_markup_mode=None
)
UNITS_HELP = "Unit of length, against what the file says: mm, cm, m, inch or foot."
ROTARY_HELP = "Rotary axes of the machine from part to tool, for 5-axis G-code: C,A."
KINDS = {
    "unknown": "not understood (irb2400 plan refuses the file)",
    "assumed": "assumed",
    "ignored": "left out, moves nothing",
}


@app.callback()
def main() -> None:
    """Look at a CAM file or a tool path."""


@app.command()
@answers
def show(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="CSV, APT/CLDATA (NX, Creo, CATIA) or G-code.")
    ],
    units: Annotated[str | None, typer.Option("--units", help=UNITS_HELP)] = None,
    rotary: Annotated[str | None, typer.Option("--rotary", help=ROTARY_HELP)] = None,
) -> Summary:
    """Print the operations: tool, points, length, feed, extent; what was not understood."""
    input_file(file, "a CAM file (CSV, APT/CLDATA or G-code)")

    from irb2400_ctrl.planners import read_program

    program = read_program(file, units=units, rotary=rotary, strict=False)
    print(f"{program.name}: {program.dialect}, {len(program.operations)} operation(s)")
    for operation in program.operations:
        _print_operation(operation)
    _print_notes(program)
    return Summary(program.summary())


def _print_operation(operation: Operation) -> None:
    s = operation.summary()
    tool = s["tool"]
    number = "" if tool["number"] is None else f" {tool['number']}"
    diameter = "" if tool["diameter_mm"] is None else f", diameter {tool['diameter_mm']:g} mm"
    feed = s["feed_mm_s"]
    stated = "none stated" if feed is None else f"{feed[0]:.4g} … {feed[1]:.4g} mm/s"
    turning = f"{s['spindle_rpm']:.0f} 1/min {s['spindle']}" if s["spindle_rpm"] else "not stated"
    low, high = s["extent_mm"]
    extent = ", ".join(
        f"{axis} {a:.3f} … {b:.3f}" for axis, a, b in zip("xyz", low, high, strict=True)
    )
    print(f"{s['number']}: {s['name']} (lines {s['lines'][0]} to {s['lines'][1]})")
    print(f"   tool{number} {tool['name']}{diameter}; spindle {turning}; coolant {s['coolant']}")
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
