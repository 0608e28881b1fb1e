"""What is known before anything is explained: noise, errors, how far the base may be off."""

from irb2400_ctrl.diagnosis.preparation.base_prior import Nuisance, Uncertainty
from irb2400_ctrl.diagnosis.preparation.metrics import Errors, errors, noise_floor
from irb2400_ctrl.diagnosis.preparation.noise import Noise

__all__ = ["Errors", "Noise", "Nuisance", "Uncertainty", "errors", "noise_floor"]
