"""What stands around an arm, and how near the arm comes to it and to itself."""

from irb2400_ctrl.cell.description import Cell, CellTool, Mesh, Placed, Rail, Thing
from irb2400_ctrl.cell.file import load_cell
from irb2400_ctrl.cell.kept_apart import with_kept_apart
from irb2400_ctrl.cell.piece import with_tool
from irb2400_ctrl.cell.scene import Scene

__all__ = [
    "Cell",
    "CellTool",
    "Mesh",
    "Placed",
    "Rail",
    "Scene",
    "Thing",
    "load_cell",
    "with_kept_apart",
    "with_tool",
]
