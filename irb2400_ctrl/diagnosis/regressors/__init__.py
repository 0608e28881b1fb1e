"""What every effect would show on a log."""

from irb2400_ctrl.diagnosis.regressors.bases import Bases, RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque, predicted_torque

__all__ = ["Bases", "RegressorColumns", "effect_torque", "predicted_torque"]
