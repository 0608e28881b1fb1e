"""Wrong torque constant in the measuring chain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import GAIN, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect, Link
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import EXACT, Prior
from irb2400_ctrl.effects.signals import Signals

LEAST = 0.4
MOST = 2.5
"""readings over true torques that have a name: phases for lines are 1.7, currents of two motors 2;
what is further off is another unit, for which a log is refused"""


class TorqueGain(Effect):
    """measured tau_j = gain * tau_j."""

    acts: ClassVar[Acts] = "measurement"
    chain: ClassVar[Link] = "reading"
    sentence: ClassVar[str] = (
        "the reported torque of the joint is a constant multiple of the true one"
    )
    example: ClassVar[Mapping[str, Any]] = {"gain": 1.1}
    ambiguity: ClassVar[Ambiguity] = GAIN
    # quadratic in a load that a payload found beside it changes
    prior: ClassVar[Prior] = Prior(
        lasting=0,
        leftover=("load", "load over time", "friction over load"),
        # a reading that bends with the torque is a motor in saturation, and no constant factor
        discrepancy_share=EXACT,
    )
    drawing: ClassVar[Drawing] = Drawing("load")

    kind: Literal["torque_gain"] = "torque_gain"
    gain: float = Field(gt=0, description="measured over true torque [-]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.tau[self.index], s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        tau = s.tau[self.index]
        return self.on(tau * ca.fabs(tau), s.q.numel())

    def _shown(self, time: Array, tau: Array) -> Array:
        shown = np.array(tau)
        true = tau[:, self.index]
        shown[:, self.index] = self.gain * true + sum(self.discrepancy) * true * np.abs(true)
        return shown

    @property
    def unlikely(self) -> bool:
        # no torque constant is known to three per cent
        return abs(self.gain - 1.0) < 0.03 or not LEAST < self.gain < MOST

    def coefficients(self) -> tuple[float, ...]:
        return (self.gain - 1.0,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, gain=1.0 + coefficients[0])
