"""`place`: the pose of a work object that leaves the largest margins."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, one_thread
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.planners.placement.area import Area, Standing, middle_of
from irb2400_ctrl.planners.placement.outlook import Outlook, outlook
from irb2400_ctrl.planners.placement.proof import Proof, prove
from irb2400_ctrl.planners.placement.room import Room
from irb2400_ctrl.planners.placement.search import Look, Search
from irb2400_ctrl.planners.placement.task import COARSE, FINE, Task, tasks_of, thinned
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram
from irb2400_ctrl.robot import Robot

Progress = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Placement:
    """What `place` found."""

    robot: Robot
    parts: tuple[str, ...]
    start: Outlook
    found: Outlook
    proof: Proof
    """of the place that was found, over the continuous path"""
    start_proof: Proof
    middle: Array
    """of the part, in the work object's frame [m], shape (3,)"""
    area: Area
    seen: tuple[tuple[Standing, Outlook], ...]
    """every place that was looked at"""
    load: CuttingLoad | None = None
    overlapping: tuple[str, ...] = ()
    """what stands in what at the start, and may do so elsewhere"""

    def summary(self) -> dict[str, Any]:
        """The content of `placement.json`."""
        return {
            "schema_version": 1,
            "robot": self.robot.name,
            "parts": list(self.parts),
            "start": {**self.start.summary(), "continuous": self.start_proof.summary()},
            "found": {**self.found.summary(), "continuous": self.proof.summary()},
            "cutting_force": None if self.load is None else self.load.summary(),
            "looked_at": len(self.seen),
            "map": [
                {
                    "middle_mm": [round(1e3 * v, 2) for v in at.middle],
                    "turn_deg": round(float(np.degrees(at.turn)), 2),
                    "worth": round(outlook.worth, 4),
                    "worst": outlook.worst,
                    "deflection_mm": None
                    if outlook.deflection is None
                    else round(1e3 * outlook.deflection, 4),
                }
                for at, outlook in self.seen
            ],
        }


@one_thread()
def place(
    robot: Robot,
    programs: Sequence[CamProgram],
    *,
    start: Array | None = None,
    area: Area | None = None,
    free_tool_rotation: bool = True,
    cell: Cell | None = None,
    tool: str | None = None,
    load: CuttingLoad | None = None,
    progress: Progress | None = None,
) -> Placement:
    """The pose of the work object whose worst margin is largest.

    Margins (joint box, singularities, reach, torque, feed, clearance) are seen at stations, each as
    a part of what is comfortable. The best place is then shown on the continuous path.

    Args:
        robot: the arm.
        programs: what is done on the part, all in the frame of the work object.
        start: pose X_BW that the part stands at now, shape (4, 4); default the cell's work object,
            or the base. How it is tilted there, it stays.
        area: where its middle may be.
        free_tool_rotation: whether the tool may turn about its axis.
        cell: what stands around the arm; what stands on the work object moves with it.
        tool: of the cell, for all operations.
        load: a force on the tip, in the work object's frame: of places with alike margins the one
            that gives way least is taken.
        progress: called with what is being looked at.

    Raises:
        UnreachableError: no place of the area will do; says what is in the way.
    """
    told = progress or (lambda stage: None)
    first = np.eye(4) if start is None else np.asarray(start, dtype=float)
    if start is None and cell is not None and cell.work_frame is not None:
        first = cell.work_frame
    around = None if cell is None else cell.placed(first)
    operations = [operation for program in programs for operation in program.operations]
    tasks = tasks_of(robot, operations, free_tool_rotation, around, tool)
    centre = middle_of(tasks)
    where = area or Area.around(tasks[0].model, np.radians([0.0, 90.0, 180.0, 270.0]))

    def pose(at: Standing) -> Array:
        return at.pose(first[:3, :3], centre, robot.upright)

    search = Search(where)
    room = Room.of_part(tasks[0].scene)
    coarse = thinned(tasks, operations, COARSE)
    fine = thinned(tasks, operations, FINE)
    glance = _Look(coarse, pose, load, False, told, room, first)
    search.coarse(_promising(tasks, pose), glance)
    closer = _closer(search, _standing(first, centre), replace(glance, tasks=fine, patient=True))
    told("showing the best")
    found, proof = _shown(tasks, closer, load)
    here = outlook(fine, first, load, patient=True)
    return Placement(
        robot, tuple(program.name for program in programs), here, found, proof,
        prove(tasks, first, load), centre, where, tuple(search.seen), load, room.overlapping,
    )  # fmt: skip


def _closer(search: Search, start: Standing, look: Look) -> list[tuple[Standing, Outlook]]:
    """What closer looks lead to, from the best places and from the start, best first."""
    begins = [at for at, _ in search.best()]
    # what stands well already is not made worse
    begins += [start] if search.area.holds(start.middle) else []
    found = [search.closer(at, look) for at in begins]
    return sorted(found, key=lambda pair: pair[1].rank, reverse=True)


def _standing(X_BW: Array, centre: Array) -> Standing:
    """As it stands at first."""
    return Standing(X_BW[:3, :3] @ centre + X_BW[:3, 3], 0.0)


def _shown(
    tasks: list[Task], closer: list[tuple[Standing, Outlook]], load: CuttingLoad | None
) -> tuple[Outlook, Proof]:
    """The best place that holds on the continuous path.

    Raises:
        UnreachableError: none does.
    """
    reasons = []
    for _, seen in closer:
        if seen.refused:
            reasons.append(seen.refused)
            continue
        proof = prove(tasks, seen.X_BW, load)
        if not proof.refused:
            return seen, proof
        reasons.append(proof.refused)
    why = "; ".join(dict.fromkeys(reasons)) or "all of it is too far from the arm"
    raise UnreachableError(
        f"no place in the area lets the arm do all operations: {why}; widen the area (--area), "
        "free the tool rotation, or place the operations one by one"
    )


@dataclass(eq=False)
class _Look:
    """What a place of the work object is worth."""

    tasks: list[Task]
    pose: Callable[[Standing], Array]
    load: CuttingLoad | None
    patient: bool
    told: Progress
    room: Room
    first: Array
    """pose of the work object that the room is stated at, shape (4, 4)"""
    count: int = 0

    def __call__(self, at: Standing) -> Outlook:
        self.count += 1
        if self.count % 20 == 0:
            self.told(f"{self.count} places")
        X = self.pose(at)
        taken = self.room.taken(X @ np.linalg.inv(self.first))
        if taken:
            return Outlook(X, {}, refused=taken)
        return outlook(self.tasks, X, self.load, self.patient)


def _promising(tasks: list[Task], pose: Callable[[Standing], Array]) -> Callable[[Standing], bool]:
    """Whether all way-points are within a sphere that the tip cannot leave."""
    model = tasks[0].model
    g = model.arm_geometry
    robot = model.robot
    tip = float(np.linalg.norm((robot.flange.matrix() @ robot.X_FT)[:3, 3])) + abs(g.d7)
    reach = abs(g.a1) + g.a2 + g.forearm_reach() + tip
    foot = g.X_B0[:3, 3] + g.X_B0[:3, 2] * g.d1
    points = np.concatenate([task.path.position for task in tasks])
    if not len(points):
        raise InputError("place: found no way-points, expected an operation with some")

    def inside(at: Standing) -> bool:
        X = pose(at)
        placed = points @ X[:3, :3].T + X[:3, 3] - foot
        return bool((np.linalg.norm(placed, axis=1) < reach).all())

    return inside
