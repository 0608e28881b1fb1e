"""RAPID modules of an ABB controller, written and read back."""

from irb2400_ctrl.planners.programs.rapid.rapid_program import (
    RapidOptions,
    RapidProgram,
    rapid_program,
)
from irb2400_ctrl.planners.programs.rapid.rapid_reader import RapidModule, RapidMove, read_rapid

__all__ = [
    "RapidModule",
    "RapidMove",
    "RapidOptions",
    "RapidProgram",
    "rapid_program",
    "read_rapid",
]
