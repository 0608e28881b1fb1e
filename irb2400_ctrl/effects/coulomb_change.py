"""Coulomb friction that has changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import FRICTION_LEVEL, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.signals import Signals

NEAR_REVERSAL = (0.05, 0.3)
"""[rad/s] speeds over which dry friction may depart from its level after a reversal"""


class CoulombChange(Effect):
    """tau_j = dF_c sgn(qd_j)."""

    sentence: ClassVar[str] = "dry friction of the joint is not what the robot file says"
    example: ClassVar[Mapping[str, Any]] = {"coulomb_Nm": 1.0}
    ambiguity: ClassVar[Ambiguity] = replace(
        FRICTION_LEVEL, change_of=("coulomb", "static"), limit_of=("hysteresis",)
    )
    prior: ClassVar[Prior] = Prior(leftover=("speed",))
    drawing: ClassVar[Drawing] = Drawing("qd")

    kind: Literal["coulomb_change"] = "coulomb_change"
    coulomb_Nm: float = Field(description="change of the Coulomb level [Nm]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.sign[self.index], s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        speed = ca.fabs(s.qd[self.index])
        n = s.q.numel()
        return ca.horzcat(
            *[self.on(s.sign[self.index] * ca.exp(-speed / v), n) for v in NEAR_REVERSAL]
        )
