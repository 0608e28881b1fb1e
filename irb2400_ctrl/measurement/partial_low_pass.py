"""The common low-pass of a log of which some samples do not count."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.measurement.uniform import Kept, LowPass, Recorders

LEAST_SHARE = 0.25
"""of the filter's weight that lies on the samples of a row that is known"""


@dataclass(frozen=True, eq=False, kw_only=True)
class PartialLowPass(LowPass):
    """Each row a weighted mean of the samples that count, sum_i w_i c_i x_i / sum_i w_i c_i, alike
    of measured torques and of all that they are compared with.

    Args:
        whole: the low-pass over all samples; counts: those that do, shape (m,).
    """

    whole: LowPass
    counts: Mask

    @staticmethod
    def of(whole: LowPass, counts: Mask) -> PartialLowPass:
        """Arguments as of the class."""
        like = (whole.cutoff, whole.step, whole.band)
        return PartialLowPass(*like, whole=whole, counts=counts)

    @property
    def known(self) -> Mask:
        """Rows with enough samples, shape (rows,)."""
        return np.asarray(self._shares > LEAST_SHARE)

    @cached_property
    def _shares(self) -> Array:
        return self.whole(self.counts.astype(float))

    def __call__(self, signal: Array, recorders: Recorders = (None,)) -> Array:
        """As of `LowPass`; rows of too few samples are not known."""
        each = (-1, *(1,) * (signal.ndim - 1))
        rows = self.whole(signal * self.counts.reshape(each), recorders)
        return np.asarray(rows / np.where(self.known, self._shares, 1.0).reshape(each))

    def instants(self, signal: npt.NDArray[Kept]) -> npt.NDArray[Kept]:
        return self.whole.instants(signal)
