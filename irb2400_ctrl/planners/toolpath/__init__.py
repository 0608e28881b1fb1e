"""What the tool shall do: way-points read or built, their smooth curve, its orientations."""

from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.positioner import (
    Positioner,
    PositionerAxis,
    Setting,
    choose_settings,
)
from irb2400_ctrl.planners.toolpath.read_path import read_path
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve, smooth_curve
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

__all__ = [
    "Orientation",
    "Positioner",
    "PositionerAxis",
    "Setting",
    "TaskCurve",
    "ToolPath",
    "builders",
    "choose_settings",
    "read_path",
    "smooth_curve",
]
