"""Spring or gas balancer that carries part of an axis' weight."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import GAIN, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals

POLYTROPIC = 1.25
"""exponent of nitrogen between slow and quick strokes (1 and 1.4)"""


class Balancer(Effect):
    """tau_j = T (1 - l0 / l(d)) (l_s / l(d))^n sin d, d = q_j - q_0, l(d)^2 = 1 + rho^2 - 2 rho cos
    d.

    A spring between the base and a lever on the link: lever ratio rho = lever / base distance, all
    lengths in units of the base distance, l0 = free_ratio * (1 - rho). T = stiffness * lever * base
    distance; T > 0 pulls towards q_0, T < 0 pushes away. free_ratio < 0: a spring that is loaded at
    its shortest, far below nothing a gas cylinder, of which the force hardly changes; n > 0: of one
    that compresses its gas, with the polytropic exponent n, towards its shortest l_s = 1 - rho.
    """

    sentence: ClassVar[str] = (
        "a balancing spring or gas cylinder helps the axis to carry its weight"
    )
    example: ClassVar[Mapping[str, Any]] = {"torque_Nm": 100.0, "free_ratio": 0.45}
    ambiguity: ClassVar[Ambiguity] = GAIN
    search: ClassVar[Search] = Search(between_grid=True)
    prior: ClassVar[Prior] = Prior(
        fields={"lever_ratio": (0.4, 0.15), "free_ratio": (0.0, 1.0)},
        leftover=("angle",),
        fixed=("gas_exponent",),
    )

    kind: Literal["balancer"] = "balancer"
    torque_Nm: float = Field(description="stiffness times both lever arms T [Nm]")
    neutral_rad: float = Field(default=0.0, description="angle q_0 of the dead centre [rad]")
    lever_ratio: float = Field(
        default=0.3, gt=0, lt=1, description="lever over base distance rho [-]"
    )
    free_ratio: float = Field(
        default=0.0, ge=-10, le=1, description="free length over shortest length [-]"
    )
    gas_exponent: float = Field(
        default=0.0, ge=0, le=2, description="polytropic exponent n of a gas, 0: a spring [-]"
    )

    def basis(self, s: Signals) -> ca.SX:
        d = s.q[self.index] - self.neutral_rad
        rho = self.lever_ratio
        length = ca.sqrt(1 + rho**2 - 2 * rho * ca.cos(d))
        shortest = (1 - rho) / length
        force = (1 - self.free_ratio * shortest) * shortest**self.gas_exponent
        return self.on(force * ca.sin(d), s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        d = s.q[self.index] - self.neutral_rad
        n = s.q.numel()
        return ca.horzcat(
            self.on(ca.cos(d), n), self.on(ca.sin(2 * d), n), self.on(ca.cos(2 * d), n)
        )

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [
            {
                "neutral_rad": math.radians(angle),
                "lever_ratio": lever,
                "free_ratio": free,
                "gas_exponent": gas,
            }
            for angle in range(-180, 180, 10)
            for lever in (0.3, 0.5)
            for free, gas in ((-4.0, 0.0), (0.0, 0.0), (0.9, 0.0), (-4.0, POLYTROPIC))
        ]

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        return range(2, min(n, 3) + 1)
