"""How far a motion stays from itself and from its cell, at every place of it."""

from irb2400_ctrl.planners.clearance.clearance import Clearance
from irb2400_ctrl.planners.clearance.contact import cutting_moves
from irb2400_ctrl.planners.clearance.continuous import continuous_clearance

__all__ = ["Clearance", "continuous_clearance", "cutting_moves"]
