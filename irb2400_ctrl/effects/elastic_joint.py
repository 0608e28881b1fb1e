"""Elasticity of a joint's transmission."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.base import Effect, Signals


class ElasticJoint(Effect):
    """Link angle q_j - load_j / k: below the resonance the arm stands and accelerates a little behind its motors.

    To first order in the compliance 1/k: tau = tau_rigid - (M(:, j) d2 load_j / dt2 + dtau/dq_j load_j) / k. A simulation
    that wants the resonance itself uses `stiffness_Nm_rad` and `damping_Nms_rad` for a further state per joint.
    """

    abscissa = "load"
    group: ClassVar[str] = "dynamic"
    splits: ClassVar[str] = "excitation near the resonance"
    sentence: ClassVar[str] = (
        "the transmission of the joint twists under load: the link lags and swings behind the motor"
    )

    fixed: ClassVar[tuple[str, ...]] = ("damping_Nms_rad",)

    kind: Literal["elastic_joint"] = "elastic_joint"
    stiffness_Nm_rad: float = Field(gt=0, description="torsional stiffness k [Nm/rad]")
    damping_Nms_rad: float = Field(default=0.0, ge=0, description="damping of the spring [Nm s/rad]")

    def basis(self, s: Signals) -> ca.SX:
        return (
            -s.mass_matrix[:, self.index] * s.load_rate2[self.index]
            - s.tau_jacobian[:, self.index] * s.load[self.index]
        )

    def coefficients(self) -> tuple[float, ...]:
        return (1.0 / self.stiffness_Nm_rad,)

    @classmethod
    def from_coefficients(cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]) -> Self:
        return cls.of(joint, stiffness_Nm_rad=1.0 / coefficients[0])
