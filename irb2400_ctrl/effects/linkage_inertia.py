"""Lever and rod of the parallelogram, which the paper neglects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import MASS, Ambiguity
from irb2400_ctrl.effects.base import STANDARD_GRAVITY, Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.signals import Signals


class LinkageInertia(Effect):
    """tau_3 = J qdd_3 - 9.81 S cos(q_3): a lever on the axis of q_3 with inertia J and static
    moment S."""

    sentence: ClassVar[str] = (
        "the rod and lever of the parallelogram have a mass that the model neglects"
    )
    example: ClassVar[Mapping[str, Any]] = {"inertia_kgm2": 3.0, "moment_kgm": 2.0}
    ambiguity: ClassVar[Ambiguity] = replace(
        MASS, splits="not separable from the moments of links 2 and 3 in the base set"
    )
    drawing: ClassVar[Drawing] = Drawing("qdd")

    kind: Literal["linkage_inertia"] = "linkage_inertia"
    inertia_kgm2: float = Field(ge=0, description="inertia J about the axis of q_3 [kg m2]")
    moment_kgm: float = Field(default=0.0, description="static moment S along the forearm [kg m]")

    def basis(self, s: Signals) -> ca.SX:
        j = self.index
        n = s.q.numel()
        return ca.horzcat(self.on(s.qdd[j], n), self.on(-STANDARD_GRAVITY * ca.cos(s.q[j]), n))

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        # the rod's centre of mass beside the forearm's line
        return self.on(ca.sin(s.q[self.index]), s.q.numel())

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        # the moment shows far more than the inertia, which noise may turn below zero
        return cls.of(joint, inertia_kgm2=max(0.0, coefficients[0]), moment_kgm=coefficients[1])

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        return range(3, min(n, 3) + 1)
