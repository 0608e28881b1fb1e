"""What the controller receives: rows of a trajectory, what is read between them, and its bounds."""

from irb2400_ctrl.planners.timing.sampled_reference.interpolation import Interpolation
from irb2400_ctrl.planners.timing.sampled_reference.sampled_reference import SampledReference

__all__ = ["Interpolation", "SampledReference"]
