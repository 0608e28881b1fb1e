"""What is known before anything is explained: noise, errors, how far the base may be off."""

from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.preparation.metrics import Errors, errors, noise_floor
from irb2400_ctrl.diagnosis.preparation.noise import Noise

__all__ = ["BasePrior", "Errors", "Noise", "errors", "noise_floor"]
