"""Viscous friction that grows less (or more) than proportionally with speed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import VISCOUS, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.signals import Signals


class ViscousPower(Effect):
    """tau_j = c |qd_j|^p sgn(qd_j), p != 1."""

    sentence: ClassVar[str] = "friction of the joint does not grow in proportion to its speed"
    example: ClassVar[Mapping[str, Any]] = {"coefficient": 1.0, "exponent": 0.5}
    ambiguity: ClassVar[Ambiguity] = VISCOUS
    prior: ClassVar[Prior] = Prior(leftover=("speed",))
    drawing: ClassVar[Drawing] = Drawing("qd")

    kind: Literal["viscous_power"] = "viscous_power"
    coefficient: float = Field(description="torque at 1 rad/s [Nm]")
    exponent: float = Field(gt=0, le=3, description="exponent p [-]")

    def basis(self, s: Signals) -> ca.SX:
        speed = s.qd[self.index]
        return self.on(ca.fabs(speed) ** self.exponent * ca.sign(speed), s.q.numel())

    def sizes(self) -> tuple[float, ...]:
        """How much it bends at 1 rad/s, as d^2 tau / d qd^2: at an exponent of 0 it is dry
        friction, at 1 viscous, which every joint has."""
        return (self.coefficient * self.exponent * (self.exponent - 1.0),)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [{"exponent": p} for p in (0.4, 0.6, 1.5, 2.0, 2.5)]
