"""Coulomb friction that has changed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.base import Effect, Signals


class CoulombChange(Effect):
    """tau_j = dF_c sgn(qd_j)."""

    abscissa = "qd"
    group: ClassVar[str] = "friction level"
    splits: ClassVar[str] = "a second payload, poses with a small load torque"
    sentence: ClassVar[str] = "dry friction of the joint is not what the robot file says"

    kind: Literal["coulomb_change"] = "coulomb_change"
    coulomb_Nm: float = Field(description="change of the Coulomb level [Nm]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.sign[self.index], s.q.numel())

    def departures(self, s: Signals) -> ca.SX:
        speed = ca.fabs(s.qd[self.index])
        n = s.q.numel()
        return ca.horzcat(
            *[self.on(s.sign[self.index] * ca.exp(-speed / v), n) for v in (0.05, 0.3)]
        )

    def coefficients(self) -> tuple[float, ...]:
        return (self.coulomb_Nm,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, coulomb_Nm=coefficients[0])
