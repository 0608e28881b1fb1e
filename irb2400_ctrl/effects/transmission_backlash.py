"""Lost motion in the transmission."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.base import Acts, Effect, Signals


class TransmissionBacklash(Effect):
    """link angle q_j - (gap / 2) sgn(load_j), to first order tau - (dtau/dq_j)(gap / 2) sgn(load_j)."""

    acts: ClassVar[Acts] = "measurement"
    abscissa = "load"
    group: ClassVar[str] = "position error"
    splits: ClassVar[str] = "poses or payloads where the load torque changes sign"
    sentence: ClassVar[str] = (
        "the gear of the joint has play: the link stands half the gap away from where the motor says"
    )

    kind: Literal["transmission_backlash"] = "transmission_backlash"
    gap_rad: float = Field(ge=0, description="full lost motion [rad]")

    def basis(self, s: Signals) -> ca.SX:
        return -0.5 * s.tau_jacobian[:, self.index] * ca.sign(s.load[self.index])

    def coefficients(self) -> tuple[float, ...]:
        return (self.gap_rad,)

    @classmethod
    def from_coefficients(cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]) -> Self:
        return cls.of(joint, gap_rad=coefficients[0])
