"""`irb2400 place --rail`: where on its rail the carriage should stand."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from irb2400_ctrl.cli.command_line import provenance
from irb2400_ctrl.cli.planning.margin_lines import margin_lines
from irb2400_ctrl.cli.progress import step
from irb2400_ctrl.cli.summary import Summary, wrote
from irb2400_ctrl.errors import InputError

if TYPE_CHECKING:
    from irb2400_ctrl.cell import Cell
    from irb2400_ctrl.planners import CamProgram
    from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
    from irb2400_ctrl.robot import Robot


def on_rail(
    arm: Robot,
    programs: Sequence[CamProgram],
    cell: Cell | None,
    free: bool,
    tool: str | None,
    load: CuttingLoad | None,
    out: Path,
) -> Summary:
    """Find the place of the carriage -> placement.json, report.html."""
    from irb2400_ctrl.files import write_json
    from irb2400_ctrl.planners.placement import rail_position
    from irb2400_ctrl.report.pages.placement_page import rail_page

    if cell is None:
        raise InputError("--rail: found no --cell, expected the cell file that has the [rail]")
    with step("looking along the rail"):
        found = rail_position(arm, programs, cell, free_tool_rotation=free, tool=tool, load=load)
    facts = found.summary()
    written = [write_json(out / "placement.json", facts)]
    page = rail_page(found, arm, cell)
    page.provenance(provenance(arm))
    written.append(page.write(out / "report.html"))
    for name in ("start", "found"):
        if facts[name]["refused"]:
            print(f"{name}: {facts[name]['refused']}")
    for line in margin_lines(facts["start"], facts["found"]):
        print(line)
    print(f"in the cell file: [rail] position_mm = {found.position_mm:g}")
    return wrote(facts, written)
