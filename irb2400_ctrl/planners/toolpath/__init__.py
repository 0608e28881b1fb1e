"""What the tool shall do: way-points read or built, their smooth curve, its orientations."""

from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.planners.toolpath.cam_program import (
    CamProgram,
    Event,
    Note,
    Operation,
    Spindle,
    Tool,
)
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.positioner import (
    Positioner,
    PositionerAxis,
    Setting,
    choose_settings,
)
from irb2400_ctrl.planners.toolpath.read_path import read_path, read_program
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve, smooth_curve
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

__all__ = [
    "CamProgram",
    "Event",
    "Note",
    "Operation",
    "Orientation",
    "Positioner",
    "PositionerAxis",
    "Setting",
    "Spindle",
    "TaskCurve",
    "Tool",
    "ToolPath",
    "builders",
    "choose_settings",
    "read_path",
    "read_program",
    "smooth_curve",
]
