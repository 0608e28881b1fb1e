"""Friction that differs between the two directions of motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import OFFSET, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Nested, Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class CoulombAsymmetry(Effect):
    """tau_j = delta |sgn(qd_j)| + eta |qd_j|: Coulomb level F_c + delta forwards and F_c - delta
    backwards, viscous coefficient F_v + eta and F_v - eta; nothing at rest."""

    sentence: ClassVar[str] = "friction of the joint is larger in one direction than in the other"
    example: ClassVar[Mapping[str, Any]] = {"delta_Nm": 1.0}
    ambiguity: ClassVar[Ambiguity] = OFFSET
    prior: ClassVar[Prior] = Prior(leftover=("speed",), absent=("viscous_Nms_rad",))
    search: ClassVar[Search] = Search(nothing_at_turns=True)
    drawing: ClassVar[Drawing] = Drawing("qd")

    kind: Literal["coulomb_asymmetry"] = "coulomb_asymmetry"
    delta_Nm: float = Field(description="half the difference of the two Coulomb levels [Nm]")
    viscous_Nms_rad: float = Field(
        default=0.0, description="half the difference of the two viscous coefficients [Nm s/rad]"
    )

    @classmethod
    def nested(cls, mass: float, reach: float, axis: Array) -> Sequence[Nested]:
        """Dry friction alone, then viscous too.

        Args:
            mass, reach, axis: of the arm, which do not matter.
        """
        return [Nested(np.eye(2)[:, :k], ()) for k in (1, 2)]

    def basis(self, s: Signals) -> ca.SX:
        n = s.q.numel()
        speed = s.qd[self.index]
        return ca.horzcat(self.on(s.sign[self.index] ** 2, n), self.on(ca.fabs(speed), n))

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        speed = ca.fabs(s.qd[self.index])
        n = s.q.numel()
        return ca.horzcat(self.on(ca.exp(-speed / 0.1), n), self.on(s.sign[self.index], n))
