"""Elasticity of a joint's transmission, with its resonance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import DYNAMIC, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.link_lag import lag_torque
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals
from irb2400_ctrl.effects.transmission import Transmission, wound

DAMPED = 0.9
"""damping ratio without a resonance"""
LEAST_SHOWN = 0.1
"""share of swing or twist that stiffness and load give, below which nothing shows"""
LEAST_SWING = 0.3
"""swing over twist, both over what stiffness and load give: one spring does both, and what twists
but hardly swings lags for another reason (play, a liquid at the tool). Of twelve arms with a soft
transmission 0.49 to 1.13, of five others that passed for one 0.00 to 0.08"""
USUAL_RESONANCE_Hz = 7.0
STIFFENING_PER_RAD = (60.0, 200.0, 700.0)
"""strain-wave gears are twice as stiff at their rated torque as at none, twisted by 1 to 3 mrad"""


class ElasticJoint(Effect):
    """The link swings on a spring k behind its motor: link angle q_j - x / k with the spring torque
    x,

    x'' + 2 zeta w x' + w^2 x = w^2 load_j,  w^2 = k / M_jj(q),  tau = tau_rigid - M(:, j) x'' / k -
    (dtau/dq_j) x / k.

    A spring that stiffens, as a strain-wave gear does, carries k / a sinh(a twist): under the load
    its stiffness is k c with c = sqrt(1 + (a load_j / k)^2), and

    x'' + 2 zeta w x' + w^2 c x = w^2 c (k / a) asinh(a load_j / k),

    linear about the twist that the load gives, which the swing does not change much.

    Below the resonance x'' is d2 load_j / dt2: a slow twist, of which the torque shows the share
    `visible`. It is what the same equation gives without a resonance (zeta = 0.9); the rest is the
    swing. The other joints' springs are stiff against this one.
    """

    acts: ClassVar[Acts] = "transmission"
    sentence: ClassVar[str] = (
        "the transmission of the joint twists under load: the link lags and swings behind the motor"
    )
    example: ClassVar[Mapping[str, Any]] = {"stiffness_Nm_rad": 1e5, "damping_ratio": 0.04}
    ambiguity: ClassVar[Ambiguity] = replace(DYNAMIC, lookalikes=("transmission_backlash",))
    prior: ClassVar[Prior] = Prior(
        coefficients=((1.0, 0.12), (0.5, 0.5)),
        fields={"damping_ratio": (0.05, 0.05)},
        fixed=("swing",),
        loose=("damping_ratio", "stiffening_per_rad"),
        # steel and bearings swing on for some periods; what dies at once is no spring's doing
        largest={"damping_ratio": 0.35},
        # the swing of a real transmission, with play and a motor of its own, is followed roughly
        discrepancy_share=0.5,
    )
    search: ClassVar[Search] = Search(device="transmission")
    drawing: ClassVar[Drawing] = Drawing("load")
    states: ClassVar[tuple[str, ...]] = ("torque", "rate", "slow_torque", "slow_rate")

    kind: Literal["elastic_joint"] = "elastic_joint"
    stiffness_Nm_rad: float = Field(gt=0, description="torsional stiffness k [Nm/rad]")
    damping_ratio: float = Field(
        default=0.05, gt=0, lt=1, description="damping of the resonance zeta [-]"
    )
    stiffening_per_rad: float = Field(
        default=0.0,
        ge=0,
        description="stiffening a: twisted, the spring is cosh(a twist) times as stiff [1/rad]",
    )
    swing: float = Field(
        default=1.0,
        ge=0,
        le=2.5,
        description="size of the swing over what stiffness and load give [-]",
    )
    visible: float = Field(
        default=1.0,
        ge=0,
        le=2.5,
        description="share of the slow twist that the torque shows; the rest the drive hides [-]",
    )

    def basis(self, s: Signals) -> ca.SX:
        slow = self._lag(s, s.state[2], s.state[3], DAMPED)
        return ca.horzcat(self._lag(s, s.state[0], s.state[1], self.damping_ratio) - slow, slow)

    def _lag(self, s: Signals, x: ca.SX, rate: ca.SX, damping: float) -> ca.SX:
        """Torque of all joints of a link that lags by x / k, shape (n, 1) [Nm]."""
        return (
            lag_torque(s, self.index, x, self._acceleration(s, x, rate, damping))
            / self.stiffness_Nm_rad
        )

    def _acceleration(self, s: Signals, x: ca.SX, rate: ca.SX, damping: float) -> ca.SX:
        """d2 x / dt2 [Nm/s2]."""
        k = self.stiffness_Nm_rad
        squared = k / s.mass_matrix[self.index, self.index]
        twist = self._twist(s)
        stiffer = ca.cosh(self.stiffening_per_rad * twist)
        return squared * stiffer * (k * twist - x) - 2 * damping * ca.sqrt(squared) * rate

    def _twist(self, s: Signals) -> ca.SX:
        """What the load gives at rest [rad]."""
        return wound(s.load[self.index], self.stiffness_Nm_rad, self.stiffening_per_rad)

    def state_rate(self, s: Signals) -> ca.SX:
        x, rate, slow, slow_rate = ca.vertsplit(s.state)
        swing = self._acceleration(s, x, rate, self.damping_ratio)
        return ca.vertcat(rate, swing, slow_rate, self._acceleration(s, slow, slow_rate, DAMPED))

    def steady_state(self, s: Signals) -> ca.SX:
        torque = self.stiffness_Nm_rad * self._twist(s)
        return ca.vertcat(torque, 0, torque, 0)

    @classmethod
    def beginnings(cls) -> int:
        return 2  # the slow twist has no beginning of its own

    def transmission(self) -> Transmission:
        return Transmission(
            stiffness=self.stiffness_Nm_rad,
            damping=self.damping_ratio,
            stiffening=self.stiffening_per_rad,
        )

    @classmethod
    def representative(cls, joint: int | None, inertia: float, duration: float) -> Self:
        # a resonance that a lively motion excites
        stiffness = float(inertia * (2 * math.pi * USUAL_RESONANCE_Hz) ** 2)
        return cls.of(joint, **{**cls.example, "stiffness_Nm_rad": stiffness})

    @property
    def unlikely(self) -> bool:
        # what neither swings nor twists is no spring, nor is what only twists
        return self.swing < max(LEAST_SHOWN, LEAST_SWING * self.visible)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        swing, visible = (min(max(0.0, c), 2.5) for c in coefficients)
        return cls.of(joint, swing=swing, visible=visible, **nonlinear)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        # the resonance of a spring that stiffens is spread over what its load does
        grids = ((0.0, 24), *((stiffening, 12) for stiffening in STIFFENING_PER_RAD))
        return [
            {
                "stiffness_Nm_rad": 10 ** (2 + k / a_decade),
                "damping_ratio": 0.04,
                "stiffening_per_rad": stiffening,
            }
            for stiffening, a_decade in grids
            for k in range(9 * a_decade // 2)
        ]

    @classmethod
    def sensible(cls, nonlinear: dict[str, float], inertia: float) -> bool:
        # resonances that a moving arm excites and a record at 50 to 250 Hz still shows
        return (
            3.5
            < math.sqrt(nonlinear["stiffness_Nm_rad"] / max(inertia, 1e-6)) / (2 * math.pi)
            < 16.0
        )
