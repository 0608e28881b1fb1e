"""Delay of the torque signal against the position signal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field, model_validator

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import DELAY, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect, Link
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.signals import Signals


def late(time: Array, values: Array, delay: float) -> Array:
    """values(t - delay) of a signal; beyond the record its ends.

    Args:
        time: instants of the samples (m,), increasing [s].
        values: the signal at these instants (m,) [its unit].
        delay: how much later it is told [s].
    """
    return np.interp(time - delay, time, values)


class TimeDelay(Effect):
    """measured tau_j(t) = tau_j(t - delay), to first order tau_j - delay dtau_j/dt; without a
    joint, all alike.

    Where it is the angle that is late, q_j(t) = q_j(t - delay), the torques of all joints are those
    of the time before: tau + delay (dtau/dq_j qd_j + dtau/dqd_j qdd_j + dtau/dqdd_j qddd_j).
    """

    acts: ClassVar[Acts] = "measurement"
    chain: ClassVar[Link] = "clock"
    sentence: ClassVar[str] = "torque and position of the joint are recorded at different times"
    example: ClassVar[Mapping[str, Any]] = {"delay_s": 0.004}
    ambiguity: ClassVar[Ambiguity] = DELAY
    drawing: ClassVar[Drawing] = Drawing("time")

    kind: Literal["time_delay"] = "time_delay"
    delay_s: float = Field(description="delay [s]")
    of_angle: bool = Field(
        default=False, description="whether the joint's angle is late, not its torque [-]"
    )

    @model_validator(mode="after")
    def _an_angle_has_a_joint(self) -> Self:
        if self.of_angle and self.joint is None:
            raise ValueError(
                "of_angle: found no joint; expected the joint whose angle is late. All angles late "
                "are all torques early: a negative delay_s"
            )
        return self

    def basis(self, s: Signals) -> ca.SX:
        if self.joint is None:
            return -s.tau_rate
        torque = self.on(-s.tau_rate[self.index], s.q.numel())
        return self.of_angle * s.tau_rates[:, self.index] + (1 - self.of_angle) * torque

    @property
    def angle_error(self) -> tuple[float, float]:
        return 0.0, self.of_angle * self.delay_s

    def _shown(self, time: Array, tau: Array) -> Array:
        if self.of_angle:
            return tau
        shown = np.array(tau)
        for j in range(tau.shape[1]) if self.joint is None else [self.index]:
            shown[:, j] = late(time, tau[:, j], self.delay_s)
        return shown

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        # all angles late are all torques early
        return [{}] if joint is None else [{"of_angle": False}, {"of_angle": True}]

    @property
    def unlikely(self) -> bool:
        # time stamps of a stream are no truer than a part of its period; a torque held from sample
        # to sample, and friction at reversals, make it look a little ahead of its motion, a single
        # joint more than the whole arm
        least = 0.0007 if self.joint is None else 0.0015
        if self.of_angle:
            # no angle is recorded ahead of its time
            return self.delay_s < 0.003
        return -0.003 < self.delay_s < least

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        return (None, *range(1, n + 1))
