"""Which explanation is chosen, and when it counts."""

from irb2400_ctrl.diagnosis.comparison.comparison import Alternative, Comparison
from irb2400_ctrl.diagnosis.comparison.confidence import confidence
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.non_parametric import NonParametricLaw
from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.comparison.step import Step

__all__ = [
    "Alternative",
    "Comparison",
    "Criteria",
    "NonParametricLaw",
    "Selection",
    "Step",
    "confidence",
]
