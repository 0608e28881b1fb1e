"""A robot that is true, from sound logs of it: bodies, friction, offsets, rotors, couplings."""

from irb2400_ctrl.identification.change import diagnose_change
from irb2400_ctrl.identification.friction_curve import FrictionCurve
from irb2400_ctrl.identification.identification import Identification, LogResult
from irb2400_ctrl.identification.identify import identify
from irb2400_ctrl.identification.validation import LogComparison, Validation, validate

__all__ = [
    "FrictionCurve",
    "Identification",
    "LogComparison",
    "LogResult",
    "Validation",
    "diagnose_change",
    "identify",
    "validate",
]
