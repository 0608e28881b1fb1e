"""Viscous friction that has changed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.base import Effect, Signals


class ViscousChange(Effect):
    """tau_j = dF_v qd_j."""

    abscissa = "qd"
    group: ClassVar[str] = "viscous"
    splits: ClassVar[str] = "speeds over more than a decade, recordings spread over the warm-up"
    sentence: ClassVar[str] = (
        "speed-proportional friction of the joint is not what the robot file says"
    )

    kind: Literal["viscous_change"] = "viscous_change"
    viscous_Nms_rad: float = Field(description="change of the viscous coefficient [Nm s/rad]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.qd[self.index], s.q.numel())

    def departures(self, s: Signals) -> ca.SX:
        speed = s.qd[self.index]
        n = s.q.numel()
        return ca.horzcat(
            *[self.on(ca.fabs(speed) ** p * s.sign[self.index], n) for p in (0.5, 2.0)]
        )

    def coefficients(self) -> tuple[float, ...]:
        return (self.viscous_Nms_rad,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, viscous_Nms_rad=coefficients[0])
