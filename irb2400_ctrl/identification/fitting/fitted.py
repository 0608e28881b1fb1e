"""What a fit of an arm to recordings holds."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.estimate import Estimate
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.prior import Prior


@dataclass(frozen=True)
class Fit:
    """Numbers of a layout, and what they follow from.

    Args:
        sums: of the recordings, by block; weighted: the same of weighted samples, which the numbers
            follow from.
        correlation: samples per independent one, of each joint, shape (n,).
        free: numbers when the file hardly counts, and the torque that they leave.
        samples: the same of samples that are not weighted, no joint surer than the mean of all.
        instead: what would leave the file's bodies as they are (`Choice.instead_of_bodies`).
    """

    layout: ColumnLayout
    prior: Prior
    sums: Moments
    weighted: Moments
    numbers: Estimate
    correlation: Array
    free: Estimate
    samples: Array
    instead: tuple[Extra, ...] = ()

    @property
    def theta(self) -> Array:
        """The numbers of the columns, shape (p,)."""
        return self.numbers.theta
