"""One motion for a whole program: approach, lead-in, operation, retract, link, return."""

from irb2400_ctrl.planners.linking.link_options import LinkOptions
from irb2400_ctrl.planners.linking.program_motion import ProgramMotion
from irb2400_ctrl.planners.linking.segment import Segment, TimedEvent

__all__ = ["LinkOptions", "ProgramMotion", "Segment", "TimedEvent"]
