"""RAPID modules of an ABB controller, written, checked and read back."""

from irb2400_ctrl.planners.programs.rapid.rapid_check import RapidFault, check_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions
from irb2400_ctrl.planners.programs.rapid.rapid_program import RapidProgram, rapid_program
from irb2400_ctrl.planners.programs.rapid.rapid_reader import (
    RapidModule,
    RapidMove,
    load_rapid,
    read_rapid,
)
from irb2400_ctrl.planners.programs.rapid.rapid_signals import RapidSignal

__all__ = [
    "RapidFault",
    "RapidModule",
    "RapidMove",
    "RapidOptions",
    "RapidProgram",
    "RapidSignal",
    "check_rapid",
    "load_rapid",
    "rapid_program",
    "read_rapid",
]
