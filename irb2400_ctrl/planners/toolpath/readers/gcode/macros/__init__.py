"""Variables and expressions in G-code."""

from irb2400_ctrl.planners.toolpath.readers.gcode.macros.expressions import Expression
from irb2400_ctrl.planners.toolpath.readers.gcode.macros.variables import Variables

__all__ = ["Expression", "Variables"]
