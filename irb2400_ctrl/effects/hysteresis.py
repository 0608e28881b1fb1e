"""Hysteresis of the transmission: friction that builds up over a small angle after each
reversal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import REVERSAL, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class Hysteresis(Effect):
    """tau_j = A z - R sgn qd_j,  dz/dt = (qd_j - |qd_j| z) / width  (Dahl model; z -> sgn(qd_j)
    after a few widths).

    R = 0 is a loop on top of the joint's dry friction; R = A the joint's own dry friction that
    builds up over an angle instead of jumping.
    """

    sentence: ClassVar[str] = (
        "after each reversal the friction of the joint builds up over a small angle"
    )
    example: ClassVar[Mapping[str, Any]] = {"amplitude_Nm": 1.0, "width_rad": 0.02}
    ambiguity: ClassVar[Ambiguity] = REVERSAL
    prior: ClassVar[Prior] = Prior(in_place_of_friction=("replaced_Nm",))
    search: ClassVar[Search] = Search(turns_over_in="width_rad")
    drawing: ClassVar[Drawing] = Drawing("qd")
    states: ClassVar[tuple[str, ...]] = ("z",)

    kind: Literal["hysteresis"] = "hysteresis"
    amplitude_Nm: float = Field(ge=0, description="half height of the loop A [Nm]")
    width_rad: float = Field(gt=0, description="angle over which the loop builds up [rad]")
    replaced_Nm: float = Field(
        default=0.0, description="dry friction R of the joint that the loop takes the place of [Nm]"
    )

    def basis(self, s: Signals) -> ca.SX:
        n = s.q.numel()
        return ca.horzcat(self.on(s.state[0], n), self.on(-s.sign[self.index], n))

    @property
    def unlikely(self) -> bool:
        # beyond that it is a change of the dry friction; of many sliders most may turn over at once
        return not -2.5 < self.replaced_Nm / max(self.amplitude_Nm, 1e-9) < 1.5

    def state_rate(self, s: Signals) -> ca.SX:
        speed = s.qd[self.index]
        return (speed - ca.fabs(speed) * s.state[0]) / self.width_rad

    def steady_state(self, s: Signals) -> ca.SX:
        return s.sign[self.index]

    def settled(self, turned: ca.SX) -> tuple[ca.SX, ca.SX]:
        # 1 - z falls to its e-th part over each width; z stays between -1 and 1
        return 1 - 2 * ca.exp(-turned / self.width_rad), ca.SX(1.0)

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        return self.on(s.state[0] ** 2 * ca.sign(s.state[0]), s.q.numel())

    def sizes(self) -> tuple[float, ...]:
        return (self.amplitude_Nm,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        # a loop on top of the dry friction has no second one
        amplitude, replaced = (*coefficients, 0.0)[:2]
        return cls.of(joint, amplitude_Nm=amplitude, replaced_Nm=replaced, **nonlinear)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [{"width_rad": float(w)} for w in np.geomspace(0.00125, 0.16, 15)]
