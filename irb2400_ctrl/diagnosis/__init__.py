"""Residual between model and log, candidate effects, selection, verdict, the augmented robot."""

from irb2400_ctrl.diagnosis.diagnose import diagnose
from irb2400_ctrl.diagnosis.diagnosis import Comparison, Curve, Diagnosis, Finding, Unexplained

__all__ = ["Comparison", "Curve", "Diagnosis", "Finding", "Unexplained", "diagnose"]
