"""Torque ripple of a gear or motor."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field, field_validator

from irb2400_ctrl.effects.ambiguity import RIPPLE, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals

LEAST_ORDER = 4.0
"""periods per turn below which what repeats is a gravity or spring law"""
STEP = 0.5
"""of the orders that a diagnosis tries"""

MULTIPLES = (2.0, 3.0, 0.5)
"""of the order that a ripple also has: harmonics, and what comes once in two of it, as a wave
generator's eccentricity does"""


class GearRipple(Effect):
    """tau_j = A sin(order q_j + phase): periodic in the joint angle, `order` periods per turn."""

    sentence: ClassVar[str] = (
        "torque of the joint ripples with its angle, as a worn or eccentric gear makes it"
    )
    example: ClassVar[Mapping[str, Any]] = {"amplitude_Nm": 1.0, "order": 20.0, "phase_rad": 0.5}
    ambiguity: ClassVar[Ambiguity] = RIPPLE
    prior: ClassVar[Prior] = Prior(lasting=2 * len(MULTIPLES))
    search: ClassVar[Search] = Search(between_grid=True, repeats=True)
    SLOW: ClassVar[tuple[float, ...]] = (2.0, 3.0)
    """orders of what turns with the joint itself (gauges of a torque sensor, a bent ring), for
    which no name is given: over the usual travel they look like a spring"""

    kind: Literal["gear_ripple"] = "gear_ripple"
    amplitude_Nm: float = Field(ge=0, description="amplitude A [Nm]")
    order: float = Field(gt=0, description="periods per joint turn [-]")
    phase_rad: float = Field(default=0.0, description="phase at q = 0 [rad]")

    @field_validator("discrepancy")
    @classmethod
    def _of_all_multiples(cls, given: tuple[float, ...]) -> tuple[float, ...]:
        """Files of earlier versions have the harmonics alone."""
        whole = 2 * len(MULTIPLES)
        return (*given, 0.0, 0.0) if len(given) == whole - 2 else given

    def basis(self, s: Signals) -> ca.SX:
        angle = self.order * s.q[self.index]
        n = s.q.numel()
        return ca.horzcat(self.on(ca.sin(angle), n), self.on(ca.cos(angle), n))

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        angle = self.order * s.q[self.index]
        n = s.q.numel()
        # how it grows with the load, and is another backwards, no file keeps: a diagnosis takes of
        # these what the law cannot give, so the amplitude is that under the usual load
        waves = [f(k * angle) for k in MULTIPLES for f in (ca.sin, ca.cos)]
        grown = [ca.fabs(s.load[self.index]), s.sign[self.index]]
        waves += [by * f(angle) for by in grown for f in (ca.sin, ca.cos)]
        return ca.horzcat(*[self.on(wave, n) for wave in waves])

    @classmethod
    def representative(cls, joint: int | None, inertia: float, duration: float) -> Self:
        # the gears of a wrist have fewer teeth
        wrist = {"order": 12.0} if (joint or 1) > 3 else {}
        return cls.of(joint, **{**cls.example, **wrist})

    def coefficients(self) -> tuple[float, ...]:
        return (
            self.amplitude_Nm * ca.cos(self.phase_rad),
            self.amplitude_Nm * ca.sin(self.phase_rad),
        )

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        a, b = coefficients
        return cls.of(joint, amplitude_Nm=math.hypot(a, b), phase_rad=math.atan2(b, a), **nonlinear)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        # above 160 the 250 Hz record no longer resolves it
        return [{"order": LEAST_ORDER + STEP * k} for k in range(2 * 156 + 1)]

    @property
    def unlikely(self) -> bool:
        # a fit that follows the order down arrives at a balancer
        return self.order <= LEAST_ORDER - STEP

    @property
    def period(self) -> float | None:
        """One ripple [rad]."""
        return 2.0 * math.pi / self.order
