"""Residual between model and log, candidate effects, selection, verdict, the augmented robot."""

from irb2400_ctrl.diagnosis.body_estimates import BodyEstimate, BodyEstimates
from irb2400_ctrl.diagnosis.diagnose import diagnose
from irb2400_ctrl.diagnosis.diagnosis import Comparison, Diagnosis
from irb2400_ctrl.diagnosis.finding import Curve, Finding, Unexplained
from irb2400_ctrl.diagnosis.log_errors import LogErrors
from irb2400_ctrl.diagnosis.numbers import Number
from irb2400_ctrl.diagnosis.sound_logs import LeftOut

__all__ = [
    "BodyEstimate",
    "BodyEstimates",
    "Comparison",
    "Curve",
    "Diagnosis",
    "Finding",
    "LeftOut",
    "LogErrors",
    "Number",
    "Unexplained",
    "diagnose",
]
