"""Dry friction that grows with the load on the transmission."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.base import Effect, Signals


class LoadFriction(Effect):
    """tau_j = mu |load_j| sgn(qd_j), load the rigid-body torque (Bittencourt et al.)."""

    abscissa = "load"
    against_motion: ClassVar[bool] = True
    group: ClassVar[str] = "friction level"
    splits: ClassVar[str] = "a second payload, poses with a small load torque"
    sentence: ClassVar[str] = (
        "dry friction of the joint grows with the torque that its gear carries"
    )

    kind: Literal["load_friction"] = "load_friction"
    coefficient: float = Field(ge=0, lt=1, description="friction per load torque mu [Nm/Nm]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(ca.fabs(s.load[self.index]) * s.sign[self.index], s.q.numel())

    def departures(self, s: Signals) -> ca.SX:
        load = ca.fabs(s.load[self.index])
        n = s.q.numel()
        # a power of the load near one, in units that keep the column of the law's size
        return self.on(load * ca.log(load / 50.0 + 1e-3) * s.sign[self.index], n)

    def coefficients(self) -> tuple[float, ...]:
        return (self.coefficient,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, coefficient=coefficients[0])
