"""Delay of the torque signal against the position signal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import DELAY, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect, Link
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class TimeDelay(Effect):
    """measured tau_j(t) = tau_j(t - delay), to first order tau_j - delay dtau_j/dt; without a
    joint, all alike."""

    acts: ClassVar[Acts] = "measurement"
    chain: ClassVar[Link] = "clock"
    sentence: ClassVar[str] = "the torque of the joint is recorded later than its position"
    example: ClassVar[Mapping[str, Any]] = {"delay_s": 0.004}
    ambiguity: ClassVar[Ambiguity] = DELAY
    search: ClassVar[Search] = Search(shows_moving=True)
    drawing: ClassVar[Drawing] = Drawing("time")

    kind: Literal["time_delay"] = "time_delay"
    delay_s: float = Field(description="delay [s]")

    def basis(self, s: Signals) -> ca.SX:
        return -s.tau_rate if self.joint is None else self.on(-s.tau_rate[self.index], s.q.numel())

    def _shown(self, time: Array, tau: Array) -> Array:
        shown = np.array(tau)
        for j in range(tau.shape[1]) if self.joint is None else [self.index]:
            shown[:, j] = np.interp(time - self.delay_s, time, tau[:, j])
        return shown

    def coefficients(self) -> tuple[float, ...]:
        return (self.delay_s,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        return cls.of(joint, delay_s=coefficients[0])

    @property
    def unlikely(self) -> bool:
        # time stamps of a stream are no truer than a part of its period; a torque held from sample
        # to sample, and friction at reversals, make it look a little ahead of its motion, a single
        # joint more than the whole arm
        return -0.003 < self.delay_s < (0.0007 if self.joint is None else 0.0015)

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        return (None, *range(1, n + 1))
