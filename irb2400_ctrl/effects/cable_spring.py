"""Cable and hose package that acts as a spring on a joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import POSITION_LAW, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.prior import Nested, Prior
from irb2400_ctrl.effects.signals import Signals

DIGITS = 12
"""that `one_sided` is told to: worked out of other numbers it may be beyond 1 by their rounding"""
STIFFENING = ("stiffening_Nm_rad3", "one_sided")


class CableSpring(Effect):
    """tau_j = k u + s sqrt(3 k c) u^2 + c u^3, u = q_j - q_0; k, c >= 0, -1 <= s <= 1: the torque
    rises with the angle everywhere."""

    sentence: ClassVar[str] = (
        "a cable or hose package pulls the joint towards one angle like a spring"
    )
    example: ClassVar[Mapping[str, Any]] = {"stiffness_Nm_rad": 10.0, "neutral_rad": 0.1}
    ambiguity: ClassVar[Ambiguity] = POSITION_LAW
    prior: ClassVar[Prior] = Prior(leftover=("angle",), absent=STIFFENING)

    kind: Literal["cable_spring"] = "cable_spring"
    stiffness_Nm_rad: float = Field(ge=0, description="stiffness k [Nm/rad]")
    neutral_rad: float = Field(
        default=0.0, ge=-7, le=7, description="angle q_0 without torque [rad]"
    )

    stiffening_Nm_rad3: float = Field(
        default=0.0, ge=0, description="stiffening to either side c [Nm/rad^3]"
    )
    one_sided: float = Field(
        default=0.0, ge=-1, le=1, description="how much more it stiffens one way s [-]"
    )

    @classmethod
    def nested(cls, mass: float, reach: float, axis: Array) -> Sequence[Nested]:
        """A straight line, then a hose that stiffens.

        Args:
            mass, reach, axis: of the arm, which do not matter.
        """
        return [Nested(np.eye(4)[:, first:], ()) for first in (2, 0)]

    def basis(self, s: Signals) -> ca.SX:
        n = s.q.numel()
        q = s.q[self.index]
        return ca.horzcat(*[self.on(power, n) for power in (q**3, q**2, q, ca.SX(1.0))])

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        q = s.q[self.index]
        n = s.q.numel()
        return ca.horzcat(self.on(q**2, n), self.on(q**3, n))

    def coefficients(self) -> tuple[float, ...]:
        """Of q^3, q^2, q, 1."""
        k = self.stiffness_Nm_rad
        c = self.stiffening_Nm_rad3
        b = self.one_sided * (3 * k * c) ** 0.5
        q = self.neutral_rad
        return (
            c,
            b - 3 * c * q,
            k - 2 * b * q + 3 * c * q**2,
            -k * q + b * q**2 - c * q**3,
        )

    def sizes(self) -> tuple[float, ...]:
        return (self.stiffness_Nm_rad, self.stiffening_Nm_rad3)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        c, second, first, constant = coefficients
        if second == c == 0.0:
            return cls.of(joint, stiffness_Nm_rad=first, neutral_rad=-constant / first)
        q = cls._relaxed(coefficients)
        b = second + 3 * c * q
        k = first + 2 * b * q - 3 * c * q**2
        # of a torque that falls somewhere one of them is out of its bounds
        s = round(b / (3 * abs(k * c)) ** 0.5, DIGITS)
        return cls.of(joint, stiffness_Nm_rad=k, neutral_rad=q, stiffening_Nm_rad3=c, one_sided=s)

    @staticmethod
    def _relaxed(coefficients: Sequence[float]) -> float:
        """The angle without torque [rad], of `coefficients` of a torque that rises everywhere: the
        one real root; ValueError: there is none."""
        roots = np.roots(coefficients)
        real = roots.real[np.abs(roots.imag) < 1e-9 * (1.0 + np.abs(roots))]
        if len(real) == 0:
            raise ValueError("found a torque that is zero nowhere, expected one that rises")
        return float(real[np.argmin(np.abs(real))])
