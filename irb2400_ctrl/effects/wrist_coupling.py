"""Mechanical coupling of two neighbouring wrist axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import COUPLING, Ambiguity
from irb2400_ctrl.effects.base import Effect, Signals
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior


class WristCoupling(Effect):
    """tau_j = I qdd_k + D qd_k,  tau_k = I qdd_j + D qd_j,  k = j + 1.

    The bevel gears of a wrist turn motor k when joint j moves, so its rotor inertia and its viscous
    friction are felt on both axes.
    """

    sentence: ClassVar[str] = "moving this wrist axis drags its neighbour's motor along"
    example: ClassVar[Mapping[str, Any]] = {"inertia_kgm2": 0.05, "viscous_Nms_rad": 0.5}
    ambiguity: ClassVar[Ambiguity] = COUPLING
    # the motor's friction is no straight line over the sum of two speeds
    prior: ClassVar[Prior] = Prior(discrepancy_share=0.35)
    drawing: ClassVar[Drawing] = Drawing("qd")

    kind: Literal["wrist_coupling"] = "wrist_coupling"
    inertia_kgm2: float = Field(default=0.0, description="coupled inertia I [kg m2]")
    viscous_Nms_rad: float = Field(default=0.0, description="coupled viscous friction D [Nm s/rad]")

    def basis(self, s: Signals) -> ca.SX:
        j = self.index
        n = s.q.numel()
        columns = ca.SX(n, 2)
        for column, signal in enumerate((s.qdd, s.qd)):
            columns[j, column] = signal[j + 1]
            columns[j + 1, column] = signal[j]
        return columns

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        # action and reaction through different ratios, the motor turned along as a load of its own
        j = self.index
        n = s.q.numel()
        columns = ca.SX(n, 4)
        for column, signal in enumerate((s.qdd, s.qd)):
            columns[j, column] = signal[j + 1]
            columns[j + 1, column] = -signal[j]
            columns[j, column + 2] = signal[j]
        return columns

    def coefficients(self) -> tuple[float, ...]:
        return (self.inertia_kgm2, self.viscous_Nms_rad)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, inertia_kgm2=coefficients[0], viscous_Nms_rad=coefficients[1])

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        return range(4, n)
