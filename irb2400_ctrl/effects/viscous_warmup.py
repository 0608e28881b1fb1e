"""Viscous friction that falls while the grease warms up."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import VISCOUS, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Nested, Prior
from irb2400_ctrl.effects.signals import Signals


class ViscousWarmup(Effect):
    """tau_j = (D exp(-t / T) - D') qd_j: extra viscous friction of a cold gear, gone after a few T;
    D' where the file's friction is that of a gear that was not warm yet."""

    sentence: ClassVar[str] = "the joint runs stiffer while its grease is cold"
    example: ClassVar[Mapping[str, Any]] = {"viscous_Nms_rad": 1.0, "time_constant_s": 20.0}
    ambiguity: ClassVar[Ambiguity] = replace(VISCOUS, time_matters=True)
    prior: ClassVar[Prior] = Prior(
        time_constants=("time_constant_s",),
        leftover=("speed", "friction over time"),
        absent=("below_Nms_rad",),
    )
    drawing: ClassVar[Drawing] = Drawing("time")

    kind: Literal["viscous_warmup"] = "viscous_warmup"
    viscous_Nms_rad: float = Field(
        ge=0, description="extra viscous coefficient at t = 0 [Nm s/rad]"
    )
    below_Nms_rad: float = Field(
        default=0.0, ge=0, description="warm coefficient below the file's D' [Nm s/rad]"
    )
    time_constant_s: float = Field(gt=0, le=2000, description="warm-up time constant T [s]")

    @classmethod
    def nested(cls, mass: float, reach: float, axis: Array) -> Sequence[Nested]:
        """A gear whose warm friction is the file's, then any.

        Args:
            mass, reach, axis: of the arm, which do not matter.
        """
        return [Nested(np.eye(2)[:, :count], ()) for count in (1, 2)]

    def basis(self, s: Signals) -> ca.SX:
        speed = s.qd[self.index]
        cold = ca.exp(-s.time / self.time_constant_s) * speed
        return ca.horzcat(*[self.on(one, s.q.numel()) for one in (cold, -speed)])

    def sizes(self) -> tuple[float, ...]:
        return (self.viscous_Nms_rad,)

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        speed = s.qd[self.index]
        n = s.q.numel()
        level = ca.exp(-s.time / self.time_constant_s)
        late = s.time / self.time_constant_s
        shapes = [level * late, level * late**2]
        columns = [self.on(shape * speed, n) for shape in shapes]
        return ca.horzcat(
            *columns,
            *[self.on(level * ca.fabs(speed) ** p * s.sign[self.index], n) for p in (0.5, 2.0)],
        )

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [
            {"time_constant_s": t}
            for t in (3.0, 5.0, 7.0, 10.0, 14.0, 20.0, 28.0, 40.0, 56.0, 80.0, 160.0, 320.0)
        ]
