"""Lost motion in the transmission."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import POSITION_ERROR, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.link_lag import lag_torque
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals
from irb2400_ctrl.effects.transmission import Transmission


class TransmissionBacklash(Effect):
    """The link stands half the gap behind its motor on the side the load pushes it to: link angle
    q_j - x gap / 2 with

    x'' + 1.4 w x' + w^2 x = w^2 sgn(load_j),  tau = tau_rigid - gap / 2 (M(:, j) x'' + (dtau/dq_j)
    x).

    w = pi / crossing_s: the link crosses the gap in about that time, with a push at either side.
    """

    acts: ClassVar[Acts] = "transmission"
    # angles are the motors': controllers and planners leave the play alone
    seen_by_rigid_model: ClassVar[bool] = False
    sentence: ClassVar[str] = (
        "the gear of the joint has play: the link stands half the gap away from where the motor "
        "says"
    )
    example: ClassVar[Mapping[str, Any]] = {"gap_rad": 0.004, "crossing_s": 0.06}
    ambiguity: ClassVar[Ambiguity] = POSITION_ERROR
    prior: ClassVar[Prior] = Prior(discrepancy_share=0.5)
    search: ClassVar[Search] = Search(device="transmission", rattles=True)
    drawing: ClassVar[Drawing] = Drawing("load")
    states: ClassVar[tuple[str, ...]] = ("side", "rate")

    kind: Literal["transmission_backlash"] = "transmission_backlash"
    gap_rad: float = Field(ge=0, description="full lost motion [rad]")
    crossing_s: float = Field(
        default=0.05, gt=0, description="time in which the link crosses the gap [s]"
    )

    def basis(self, s: Signals) -> ca.SX:
        return 0.5 * lag_torque(s, self.index, s.state[0], self._acceleration(s))

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        # where the load never changes sign, play is a shifted angle
        return -0.5 * s.tau_jacobian[:, self.index] * s.state[0]

    def _acceleration(self, s: Signals) -> ca.SX:
        """d2 x / dt2 [1/s2]."""
        w = math.pi / self.crossing_s
        return w**2 * (ca.sign(s.load[self.index]) - s.state[0]) - 1.4 * w * s.state[1]

    def state_rate(self, s: Signals) -> ca.SX:
        return ca.vertcat(s.state[1], self._acceleration(s))

    def steady_state(self, s: Signals) -> ca.SX:
        return ca.vertcat(ca.sign(s.load[self.index]), 0)

    def transmission(self) -> Transmission:
        return Transmission(gap=self.gap_rad)

    def coefficients(self) -> tuple[float, ...]:
        return (self.gap_rad,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, gap_rad=coefficients[0], **nonlinear)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [{"crossing_s": t} for t in (0.02, 0.04, 0.06, 0.08, 0.12, 0.16)]
