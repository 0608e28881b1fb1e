"""`Task`: an operation at a few stations, to be looked at from many places."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Cell, Scene, with_tool
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import cutting_moves
from irb2400_ctrl.planners.redundancy.choices import cutting_at
from irb2400_ctrl.planners.redundancy.follow import arc_length, station_parameters
from irb2400_ctrl.planners.toolpath.cam_program import Operation
from irb2400_ctrl.planners.toolpath.orientation import Orientation, shape_path
from irb2400_ctrl.planners.toolpath.task_curve import TOLERANCE
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot

COARSE = (14, 12)
"""stations of all operations together, and tool rotations, of the coarse look"""
FINE = (48, 24)
"""of the closer look, and of what is reported"""
_LEAST = 4


@dataclass(frozen=True, eq=False)
class Task:
    """One operation in the frame of its work object, at stations spread over its length."""

    model: Model
    scene: Scene | None
    path: ToolPath
    orientation: Orientation
    free: bool
    """whether the tool may turn about its axis"""
    u: Array
    """curve parameters of the stations, shape (n,)"""
    s: Array
    """length along the curve at the stations [m], shape (n,)"""
    rotation: Array
    """tool rotations that are looked at [rad], shape (r,)"""
    poses: Array
    """X_WT, shape (n, r, 4, 4)"""
    feed: Array
    """at the stations, inf where none is stated [m/s], shape (n,)"""
    cutting: npt.NDArray[np.bool_]
    """whether the tool may cut there, shape (n,)"""

    def thinned(self, stations: int, turns: int) -> Task:
        """The same at so many stations and tool rotations."""
        curve = self.orientation.curve
        u = _even(station_parameters(curve, 0.02), lambda v: arc_length(curve, v), stations)
        held = curve.full and not self.free
        rotation = np.zeros(1) if held else 2 * np.pi * np.arange(turns) / turns
        near = np.minimum(u.astype(int), curve.segments - 1)
        moves = cutting_moves(self.path, self.orientation.spindle)
        return Task(
            self.model,
            self.scene,
            self.path,
            self.orientation,
            self.free,
            u,
            arc_length(curve, u),
            rotation,
            self.orientation.fan(u, rotation),
            self.path.feed[curve.origin[near]],
            cutting_at(curve, moves, u),
        )


def task_of(
    robot: Robot, operation: Operation, free: bool, cell: Cell | None, tool: str | None
) -> Task:
    """An operation, not thinned yet.

    Args:
        robot: the arm with the TCP of its file.
        operation: in the frame of the work object.
        free: whether the tool may turn about its axis.
        cell: what stands around the arm, its work object somewhere.
        tool: of the cell; None for the one with the operation's number or name, or else the robot
            file's.
    """
    name = tool
    if cell is not None and name is None:
        name = cell.tool_of(operation.tool.number, operation.tool.name)
    held = None if cell is None or name is None else cell.tool(name)
    model = Model(robot if held is None else with_tool(robot, held))
    orientation = shape_path(operation.path, robot.spindle_axis, TOLERANCE)
    scene = Scene.of(model, robot, cell, held)
    none = np.empty(0)
    return Task(
        model, scene, operation.path, orientation, free,
        none, none, none, none, none, np.empty(0, dtype=bool),
    )  # fmt: skip


def tasks_of(
    robot: Robot, operations: Sequence[Operation], free: bool, cell: Cell | None, tool: str | None
) -> list[Task]:
    """`task_of` each operation."""
    return [task_of(robot, operation, free, cell, tool) for operation in operations]


def thinned(
    tasks: Sequence[Task], operations: Sequence[Operation], size: tuple[int, int]
) -> list[Task]:
    """All operations at about so many stations together, long ones at more."""
    stations, turns = size
    lengths = np.array([sum(o.lengths()) for o in operations])
    share = lengths / max(float(lengths.sum()), 1e-9)
    counts = np.maximum(np.rint(share * stations).astype(int), _LEAST)
    return [task.thinned(int(k), turns) for task, k in zip(tasks, counts, strict=True)]


def _even(u: Array, lengths: Callable[[Array], Array], count: int) -> Array:
    """Parameters at even lengths, both ends included."""
    s = lengths(u)
    even = np.interp(np.linspace(0, s[-1], count), s, u)
    even[[0, -1]] = u[[0, -1]]
    return np.asarray(even)
