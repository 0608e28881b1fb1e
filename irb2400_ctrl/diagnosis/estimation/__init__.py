"""How well candidates explain a log, and with which numbers."""

from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Problem, Score
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter

__all__ = ["Candidate", "Fit", "Fitter", "Problem", "Score"]
