"""CasADi functions, read operation by operation."""

from irb2400_ctrl.symbolic.walk import Algebra, NoRule, Walk, as_sx, walk

__all__ = ["Algebra", "NoRule", "Walk", "as_sx", "walk"]
