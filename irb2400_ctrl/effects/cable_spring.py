"""Cable and hose package that acts as a spring on a joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import POSITION_LAW, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.signals import Signals


class CableSpring(Effect):
    """tau_j = k (q_j - q_0), k >= 0."""

    sentence: ClassVar[str] = (
        "a cable or hose package pulls the joint towards one angle like a spring"
    )
    example: ClassVar[Mapping[str, Any]] = {"stiffness_Nm_rad": 10.0, "neutral_rad": 0.1}
    ambiguity: ClassVar[Ambiguity] = POSITION_LAW
    prior: ClassVar[Prior] = Prior(leftover=("angle",))

    kind: Literal["cable_spring"] = "cable_spring"
    stiffness_Nm_rad: float = Field(ge=0, description="stiffness k [Nm/rad]")
    neutral_rad: float = Field(
        default=0.0, ge=-7, le=7, description="angle q_0 without torque [rad]"
    )

    def basis(self, s: Signals) -> ca.SX:
        n = s.q.numel()
        return ca.horzcat(self.on(s.q[self.index], n), self.on(ca.SX(1.0), n))

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        q = s.q[self.index]
        n = s.q.numel()
        return ca.horzcat(self.on(q**2, n), self.on(q**3, n))

    def coefficients(self) -> tuple[float, ...]:
        return (self.stiffness_Nm_rad, -self.stiffness_Nm_rad * self.neutral_rad)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        k, constant = coefficients
        return cls.of(joint, stiffness_Nm_rad=k, neutral_rad=-constant / k)
