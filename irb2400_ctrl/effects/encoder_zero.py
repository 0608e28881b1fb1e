"""Wrong zero of a joint encoder."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import POSITION_ERROR, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect, Link
from irb2400_ctrl.effects.prior import EXACT, Prior
from irb2400_ctrl.effects.signals import Signals


class EncoderZero(Effect):
    """measured tau = tau(q + zero e_j), to first order tau + (dtau/dq_j) zero."""

    acts: ClassVar[Acts] = "measurement"
    chain: ClassVar[Link] = "angle"
    sentence: ClassVar[str] = (
        "the encoder of the joint is mounted or calibrated with an angle error"
    )
    example: ClassVar[Mapping[str, Any]] = {"zero_rad": 0.01}
    ambiguity: ClassVar[Ambiguity] = POSITION_ERROR
    prior: ClassVar[Prior] = Prior(discrepancy_share=EXACT)

    kind: Literal["encoder_zero"] = "encoder_zero"
    zero_rad: float = Field(description="true minus reported angle [rad]")

    def basis(self, s: Signals) -> ca.SX:
        return s.tau_jacobian[:, self.index]

    @property
    def angle_error(self) -> tuple[float, float]:
        return self.zero_rad, 0.0
