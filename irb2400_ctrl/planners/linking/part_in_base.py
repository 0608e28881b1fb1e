"""Where an operation's path is in the base: in its work frame, on a positioner that may move."""

from __future__ import annotations

from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Cell
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.part_law import part_motion
from irb2400_ctrl.planners.toolpath.cam_program import Operation
from irb2400_ctrl.planners.toolpath.task_curve import TOLERANCE, smooth_curve
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot


def placed_path(operation: Operation, options: dict[str, Any]) -> ToolPath:
    """The path of an operation in the base; with a positioner that moves at zero."""
    frame = frame_of(options)
    return operation.path if frame is None else operation.path.moved(frame)


def path_in_base(robot: Robot, path: ToolPath, options: dict[str, Any]) -> ToolPath:
    """A placed path as the arm sees it: where a positioner moves, each way-point with its angles
    there."""
    cell: Cell | None = options.get("cell")
    if cell is None or cell.external_axes is None:
        return path
    tolerance = float(options.get("tolerance", TOLERANCE))
    curve = smooth_curve(path, tolerance)
    free = bool(options.get("free_tool_rotation", True)) and path.rotation is None
    part = part_motion(curve, robot.spindle_axis, cell, Model(robot), free)
    u = np.searchsorted(curve.origin, np.arange(len(path)), side="right").astype(float)
    M = part.axes.turned(part.law(u))
    return path.carried(M)


def frame_of(options: dict[str, Any]) -> Array | None:
    """The work frame that options of `plan_path` ask for: their own, or that of the cell's work
    object."""
    cell = options.get("cell")
    frame: Array | None = options.get("work_frame")
    return cell.work_frame if frame is None and cell is not None else frame
