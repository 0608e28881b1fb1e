"""Which explanation is chosen, and when it counts."""

from irb2400_ctrl.diagnosis.comparison.comparison import Judge, Rival
from irb2400_ctrl.diagnosis.comparison.confidence import confidence
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.non_parametric import Generic
from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.comparison.step import Step

__all__ = ["Criteria", "Generic", "Judge", "Rival", "Selection", "Step", "confidence"]
