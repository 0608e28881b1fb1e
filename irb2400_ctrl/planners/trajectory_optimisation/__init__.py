"""Motions whose geometry is free between way-points."""

from irb2400_ctrl.planners.trajectory_optimisation.optimise_motion import optimise_motion
from irb2400_ctrl.planners.trajectory_optimisation.optimised import MotionOutcome, Optimised

__all__ = ["MotionOutcome", "Optimised", "optimise_motion"]
