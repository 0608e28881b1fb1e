"""Lost motion in the transmission."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import POSITION_ERROR, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.link_lag import lag_torque
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals
from irb2400_ctrl.effects.transmission import Transmission

LONGEST_FLIGHT = 4.0
"""times the gap that the flight across it may tell: one gap has one size. Of eleven arms with play
0.2 to 2.3, of one with a liquid at the tool that passed for play 20"""


class TransmissionBacklash(Effect):
    """The link stands half the gap behind its motor on the side the load pushes it to: link angle
    q_j - x gap / 2 with

    x'' + 1.4 w x' + w^2 x = w^2 sgn(load_j),  tau = tau_rigid - gap / 2 (M(:, j) x'' + (dtau/dq_j)
    x),

    1 / w^2 = (crossing_s / pi)^2 + M_jj flight / (2 |load_j|).

    Between the sides no gear pushes: the load alone takes the link across, gap / 2 x'' = load_j /
    M_jj in the mean, so that a load which changes its sign slowly takes long; never in less than
    about crossing_s. The push at either side is in x''.
    """

    acts: ClassVar[Acts] = "transmission"
    # angles are the motors': controllers and planners leave the play alone
    seen_by_rigid_model: ClassVar[bool] = False
    sentence: ClassVar[str] = (
        "the gear of the joint has play: the link stands half the gap away from where the motor "
        "says"
    )
    example: ClassVar[Mapping[str, Any]] = {
        "gap_rad": 0.004,
        "crossing_s": 0.04,
        "flight_rad": 0.004,
    }
    ambiguity: ClassVar[Ambiguity] = POSITION_ERROR
    prior: ClassVar[Prior] = Prior(discrepancy_share=0.5)
    search: ClassVar[Search] = Search(device="transmission", rattles=True)
    drawing: ClassVar[Drawing] = Drawing("load")
    states: ClassVar[tuple[str, ...]] = ("side", "rate")

    kind: Literal["transmission_backlash"] = "transmission_backlash"
    gap_rad: float = Field(ge=0, description="full lost motion [rad]")
    crossing_s: float = Field(
        default=0.05, gt=0, description="shortest time in which the link crosses the gap [s]"
    )
    flight_rad: float = Field(
        default=0.0,
        ge=0,
        description="gap as the time of a free flight across it tells, 0: crossed at once [rad]",
    )

    def basis(self, s: Signals) -> ca.SX:
        return 0.5 * lag_torque(s, self.index, s.state[0], self._acceleration(s))

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        # where the load never changes sign, play is a shifted angle
        return -0.5 * s.tau_jacobian[:, self.index] * s.state[0]

    def _acceleration(self, s: Signals) -> ca.SX:
        """d2 x / dt2 [1/s2]."""
        load = ca.fabs(s.load[self.index])
        flight = s.mass_matrix[self.index, self.index] * self.flight_rad / 2
        # no load: it stays where it is
        squared = load / (load * (self.crossing_s / math.pi) ** 2 + flight + 1e-12)
        pull = squared * (ca.sign(s.load[self.index]) - s.state[0])
        return pull - 1.4 * ca.sqrt(squared) * s.state[1]

    def state_rate(self, s: Signals) -> ca.SX:
        return ca.vertcat(s.state[1], self._acceleration(s))

    def steady_state(self, s: Signals) -> ca.SX:
        return ca.vertcat(ca.sign(s.load[self.index]), 0)

    def transmission(self) -> Transmission:
        return Transmission(gap=self.gap_rad)

    @property
    def unlikely(self) -> bool:
        return self.flight_rad > LONGEST_FLIGHT * self.gap_rad

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [
            {"crossing_s": time, "flight_rad": float(gap)}
            for time in (0.04, 0.08)
            for gap in np.geomspace(1e-4, 27e-3, 6)
        ]
