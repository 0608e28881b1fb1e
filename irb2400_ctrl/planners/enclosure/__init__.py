"""Bounds that hold for every point of a path: torque, effects, place of the tool."""

from irb2400_ctrl.planners.enclosure.cells import Cells, enclose, grid
from irb2400_ctrl.planners.enclosure.deviation import Deviation, deviation, singularity_margins
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, path_dynamics
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath

__all__ = [
    "Cells",
    "Deviation",
    "PathDynamics",
    "TcpPath",
    "deviation",
    "enclose",
    "grid",
    "path_dynamics",
    "singularity_margins",
]
