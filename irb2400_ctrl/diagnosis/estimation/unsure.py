"""How unsure a prediction is, the robot's numbers being so."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.measurement.prepared_log import PreparedLog


def unsure_of(fit: Fit, motion: PreparedLog) -> Array:
    """Standard error of the prediction from that of the robot's numbers, where the torque is known,
    shape (n,) [Nm]."""
    Z = fit.Z[:, :, : len(fit.z)]
    variance = np.sum((Z @ fit.z_covariance) * Z, axis=2)
    known = motion.at_rows(motion.known.astype(float))
    return np.asarray(np.sqrt(np.sum(variance * known, axis=0) / np.maximum(known.sum(axis=0), 1)))
