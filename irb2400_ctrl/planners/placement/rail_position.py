"""`rail_position`: where on its rail the carriage should stand for a task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.planners.placement.outlook import Outlook, outlook
from irb2400_ctrl.planners.placement.proof import Proof, prove
from irb2400_ctrl.planners.placement.room import Room
from irb2400_ctrl.planners.placement.task import FINE, Task, tasks_of, thinned
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram
from irb2400_ctrl.robot import Robot

POSITIONS = 41
"""places along the rail that are looked at first; then twice as closely beside the best, twice"""


@dataclass(frozen=True, eq=False)
class RailPosition:
    """What `rail_position` found."""

    position_mm: float
    start: Outlook
    """where the carriage stands in the cell file"""
    found: Outlook
    proof: Proof
    """over the continuous path"""
    seen: tuple[tuple[float, Outlook], ...]
    """every place that was looked at [mm], along the rail"""

    def summary(self) -> dict[str, Any]:
        """The content of `placement.json` for a rail."""
        return {
            "schema_version": 1,
            "rail_mm": self.position_mm,
            "start": self.start.summary(),
            "found": {**self.found.summary(), "continuous": self.proof.summary()},
            "map": [
                {"rail_mm": at, "worth": outlook.worth, "worst": outlook.worst}
                for at, outlook in self.seen
            ],
        }


def rail_position(
    robot: Robot,
    programs: Sequence[CamProgram],
    cell: Cell,
    *,
    free_tool_rotation: bool = True,
    tool: str | None = None,
    load: CuttingLoad | None = None,
) -> RailPosition:
    """The place on the rail of a cell from where the worst margin of all operations is largest.

    The carriage stands there for the whole program; arguments are those of `place`.

    Raises:
        InputError: the cell has no rail, or no work object.
        UnreachableError: no place on the rail will do; says what is in the way.
    """
    if cell.rail is None or cell.work_frame is None:
        raise InputError(
            f"cell {cell.name}: expected a [rail] with direction and range_mm and a [work_object], "
            "found one of them missing"
        )
    # also of a carriage that might move during the cut
    cell = cell.on_rail(float(np.clip(cell.rail.stands_mm, *cell.rail.range_mm)))
    rail = cell.rail
    X_BW = cell.work_frame
    assert rail is not None
    assert X_BW is not None
    operations = [operation for program in programs for operation in program.operations]
    whole = tasks_of(robot, operations, free_tool_rotation, cell, tool)
    few = thinned(whole, operations, FINE)
    room = Room.of_cell(next((task.scene for task in whole), None))
    seen: dict[float, Outlook] = {}

    def look(position: float) -> Outlook:
        shift = rail.moved(position - rail.stands_mm)
        taken = room.taken(shift)
        if taken:
            return Outlook(shift @ X_BW, {}, refused=taken)
        return outlook(_shifted(few, shift), shift @ X_BW, load, patient=True)

    low, high = rail.range_mm
    places = np.linspace(low, high, POSITIONS)
    for _ in range(3):
        for position in places:
            seen.setdefault(float(position), look(float(position)))
        step = (places[1] - places[0]) / 2
        best = max(seen, key=lambda at: seen[at].rank)
        places = np.clip([best - step, best, best + step], low, high)
    for position in sorted(seen, key=lambda at: seen[at].rank, reverse=True)[:4]:
        shift = rail.moved(position - rail.stands_mm)
        proof = prove(_shifted(whole, shift), shift @ X_BW, load)
        if not (seen[position].refused or proof.refused):
            ordered = tuple(sorted(seen.items()))
            return RailPosition(position, look(rail.stands_mm), seen[position], proof, ordered)
    why = "; ".join(dict.fromkeys(o.refused or proof.refused for o in seen.values()))
    raise UnreachableError(
        f"no place on the rail lets the arm do all operations: {why}; move the work object "
        "(--work-frame), or place the operations one by one"
    )


def _shifted(tasks: Sequence[Task], shift: Array) -> list[Task]:
    """The same with the cell moved by `shift` (4, 4)."""
    return [
        task if task.scene is None else replace(task, scene=task.scene.shifted(shift))
        for task in tasks
    ]
