"""G-code (ISO 6983): LinuxCNC, Fanuc, FreeCAD."""

from irb2400_ctrl.planners.toolpath.readers.gcode.blocks import Block
from irb2400_ctrl.planners.toolpath.readers.gcode.program import read_gcode
from irb2400_ctrl.planners.toolpath.readers.gcode.rotary import Rotary

__all__ = ["Block", "Rotary", "read_gcode"]
