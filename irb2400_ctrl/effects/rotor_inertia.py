"""Reflected inertia of a motor rotor and gear."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import INERTIA, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import EXACT, Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class RotorInertia(Effect):
    """tau_j = J qdd_j, J >= 0 (gyroscopic terms of the fast rotor neglected)."""

    sentence: ClassVar[str] = (
        "the motor rotor of the joint resists acceleration, an inertia that the model does not "
        "carry"
    )
    example: ClassVar[Mapping[str, Any]] = {"inertia_kgm2": 1.0}
    ambiguity: ClassVar[Ambiguity] = INERTIA
    prior: ClassVar[Prior] = Prior(discrepancy_share=EXACT)
    search: ClassVar[Search] = Search(on_every_joint=True, usual=True)
    drawing: ClassVar[Drawing] = Drawing("qdd")

    kind: Literal["rotor_inertia"] = "rotor_inertia"
    inertia_kgm2: float = Field(ge=0, description="reflected inertia J [kg m2]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.qdd[self.index], s.q.numel())

    @property
    def motor_inertia(self) -> float | None:
        return self.inertia_kgm2
