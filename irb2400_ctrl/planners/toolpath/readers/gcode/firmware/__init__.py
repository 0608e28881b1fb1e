"""What firmwares of printers (Marlin, RepRap, Klipper) read in G-code, and no machine tool."""

from irb2400_ctrl.planners.toolpath.readers.gcode.firmware.printer import (
    PLASTIC,
    is_printers,
    without_plastic,
)
from irb2400_ctrl.planners.toolpath.readers.gcode.firmware.settings import without_settings

__all__ = ["PLASTIC", "is_printers", "without_plastic", "without_settings"]
