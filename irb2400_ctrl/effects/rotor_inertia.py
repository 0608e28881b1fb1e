"""Reflected inertia of a motor rotor and gear."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.base import Effect, Signals


class RotorInertia(Effect):
    """tau_j = J qdd_j, J >= 0 (gyroscopic terms of the fast rotor neglected)."""

    abscissa = "qdd"
    group: ClassVar[str] = "inertia"
    splits: ClassVar[str] = "none: on joint 1 it equals the inertia of link 1 about its axis"
    sentence: ClassVar[str] = (
        "the motor rotor of the joint resists acceleration, an inertia that the model does not "
        "carry"
    )

    kind: Literal["rotor_inertia"] = "rotor_inertia"
    inertia_kgm2: float = Field(ge=0, description="reflected inertia J [kg m2]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(s.qdd[self.index], s.q.numel())

    def coefficients(self) -> tuple[float, ...]:
        return (self.inertia_kgm2,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, inertia_kgm2=coefficients[0])
