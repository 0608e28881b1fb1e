"""Dry friction that grows with the load on the transmission."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import FRICTION_LEVEL, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class LoadFriction(Effect):
    """tau_j = mu |load_j + s f_j| sgn(qd_j), load the rigid-body torque (Bittencourt et al.).

    f_j is the friction of the base model: s of it arises behind the place where this one grows, so
    that the gear carries it too; all of it where it is the motor's torque that counts.
    """

    sentence: ClassVar[str] = (
        "dry friction of the joint grows with the torque that its gear carries"
    )
    example: ClassVar[Mapping[str, Any]] = {"coefficient": 0.05}
    ambiguity: ClassVar[Ambiguity] = FRICTION_LEVEL
    prior: ClassVar[Prior] = Prior(
        leftover=("speed", "friction over load"), lasting=1, fixed=("reference_Nm",)
    )
    search: ClassVar[Search] = Search(at_usual_load="reference_Nm")
    drawing: ClassVar[Drawing] = Drawing("load", against_motion=True)

    kind: Literal["load_friction"] = "load_friction"
    coefficient: float = Field(ge=0, lt=1, description="friction per load torque mu [Nm/Nm]")

    friction_share: float = Field(
        default=0.0,
        ge=0,
        le=1,
        description="share of the joint's friction that the gear carries [-]",
    )
    reference_Nm: float = Field(
        default=50.0,
        gt=0,
        description="load at which mu holds where friction grows with another power of it [Nm]",
    )

    def basis(self, s: Signals) -> ca.SX:
        return self.on(self._carried(s) * s.sign[self.index], s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        load = self._carried(s)
        n = s.q.numel()
        # a power of the load near one, which says nothing of its usual size; and a gear
        # that loses more braked than driven: |load| sgn(qd) sgn(load qd), else taken for a gain
        power = load * ca.log(load / self.reference_Nm + 1e-3) * s.sign[self.index]
        return ca.horzcat(self.on(power, n), self.on(s.load[self.index], n))

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [{"friction_share": share, "reference_Nm": 50.0} for share in (0.0, 1.0)]

    def _carried(self, s: Signals) -> ca.SX:
        load = s.load[self.index]
        return ca.fabs(load + self.friction_share * (s.tau[self.index] - load))
