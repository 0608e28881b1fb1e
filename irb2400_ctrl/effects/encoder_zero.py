"""Wrong zero of a joint encoder."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.base import Acts, Effect, Signals


class EncoderZero(Effect):
    """tau(q + zero e_j), to first order tau + (dtau/dq_j) zero."""

    acts: ClassVar[Acts] = "measurement"
    group: ClassVar[str] = "position error"
    splits: ClassVar[str] = "poses or payloads where the load torque changes sign"
    sentence: ClassVar[str] = (
        "the encoder of the joint is mounted or calibrated with an angle error"
    )

    kind: Literal["encoder_zero"] = "encoder_zero"
    zero_rad: float = Field(description="true minus reported angle [rad]")

    def basis(self, s: Signals) -> ca.SX:
        return s.tau_jacobian[:, self.index]

    def coefficients(self) -> tuple[float, ...]:
        return (self.zero_rad,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, zero_rad=coefficients[0])
