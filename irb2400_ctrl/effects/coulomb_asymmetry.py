"""Coulomb friction that differs between the two directions of motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import OFFSET, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class CoulombAsymmetry(Effect):
    """tau_j = delta |sgn(qd_j)|: Coulomb level F_c + delta forwards and F_c - delta backwards;
    nothing at rest."""

    sentence: ClassVar[str] = (
        "dry friction of the joint is larger in one direction than in the other"
    )
    example: ClassVar[Mapping[str, Any]] = {"delta_Nm": 1.0}
    ambiguity: ClassVar[Ambiguity] = OFFSET
    prior: ClassVar[Prior] = Prior(leftover=("speed",))
    search: ClassVar[Search] = Search(nothing_at_turns=True)
    drawing: ClassVar[Drawing] = Drawing("qd")

    kind: Literal["coulomb_asymmetry"] = "coulomb_asymmetry"
    delta_Nm: float = Field(description="half the difference of the two Coulomb levels [Nm]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.sign[self.index] ** 2, s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        speed = ca.fabs(s.qd[self.index])
        n = s.q.numel()
        return ca.horzcat(self.on(ca.exp(-speed / 0.1), n), self.on(s.sign[self.index], n))
