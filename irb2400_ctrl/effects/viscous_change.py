"""Viscous friction that has changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import VISCOUS, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.signals import Signals


class ViscousChange(Effect):
    """tau_j = dF_v qd_j."""

    sentence: ClassVar[str] = (
        "speed-proportional friction of the joint is not what the robot file says"
    )
    example: ClassVar[Mapping[str, Any]] = {"viscous_Nms_rad": 1.0}
    ambiguity: ClassVar[Ambiguity] = replace(
        VISCOUS, change_of=("viscous",), limit_of=("viscous_warmup",)
    )
    prior: ClassVar[Prior] = Prior(leftover=("speed",))
    drawing: ClassVar[Drawing] = Drawing("qd")

    kind: Literal["viscous_change"] = "viscous_change"
    viscous_Nms_rad: float = Field(description="change of the viscous coefficient [Nm s/rad]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.qd[self.index], s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        speed = s.qd[self.index]
        n = s.q.numel()
        return ca.horzcat(
            *[self.on(ca.fabs(speed) ** p * s.sign[self.index], n) for p in (0.5, 2.0)]
        )
