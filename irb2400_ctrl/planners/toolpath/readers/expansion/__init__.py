"""Arcs, splines and holes as the points and moves that stand for them."""

from irb2400_ctrl.planners.toolpath.readers.expansion.arcs import Arc
from irb2400_ctrl.planners.toolpath.readers.expansion.drilling import HoleCycle, HoleMove

__all__ = ["Arc", "HoleCycle", "HoleMove"]
