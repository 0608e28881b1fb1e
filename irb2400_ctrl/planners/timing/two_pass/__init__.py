"""The two passes over the grid of a path: as machine code, or in numpy without a C compiler."""

from irb2400_ctrl.planners.timing.two_pass.interpreted import Passed
from irb2400_ctrl.planners.timing.two_pass.machine_code import two_pass

__all__ = ["Passed", "two_pass"]
