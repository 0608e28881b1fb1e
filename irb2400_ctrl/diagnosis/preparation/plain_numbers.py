"""What a robot's numbers show of a log as its file states them, not filtered."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior


@dataclass(frozen=True)
class PlainNumbers:
    """The numbers of a robot at some instants of a log.

    Args:
        prior: what is left open about them.
        columns: d tau / d z of its unit normals z, shape (rows, n, k) [Nm]; qd: (rows, n) [rad/s].
        samples: d tau / d z at every sample, shape (m, n, k) [Nm].
    """

    prior: AnyPrior
    columns: Array
    qd: Array
    samples: Array

    def torque(self, z: Array, rows: Mask) -> Array:
        """Change of the torque of some rows by numbers z away, as a file can hold them [Nm]."""
        lifted = self.prior.lifted(self.prior.deviations(z), self.qd[rows])
        return np.asarray(self.columns[rows] @ z + lifted)
