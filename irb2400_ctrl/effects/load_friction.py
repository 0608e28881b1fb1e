"""Dry friction that grows with the load on the transmission."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import FRICTION_LEVEL, Ambiguity
from irb2400_ctrl.effects.base import Effect, Signals
from irb2400_ctrl.effects.drawing import Drawing


class LoadFriction(Effect):
    """tau_j = mu |load_j| sgn(qd_j), load the rigid-body torque (Bittencourt et al.)."""

    sentence: ClassVar[str] = (
        "dry friction of the joint grows with the torque that its gear carries"
    )
    example: ClassVar[Mapping[str, Any]] = {"coefficient": 0.05}
    ambiguity: ClassVar[Ambiguity] = FRICTION_LEVEL
    drawing: ClassVar[Drawing] = Drawing("load", against_motion=True)

    kind: Literal["load_friction"] = "load_friction"
    coefficient: float = Field(ge=0, lt=1, description="friction per load torque mu [Nm/Nm]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(ca.fabs(s.load[self.index]) * s.sign[self.index], s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
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
