"""A torque reading from which part of the accelerating torque is missing."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import INERTIA, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class AccelerationReading(Effect):
    """measured tau_j = tau_j - J qdd_j, J >= 0.

    Some drives report the current less what they command for the acceleration. It may come out
    larger than the joint's inertia, so it is no property of the arm: a controller leaves it alone.
    """

    acts: ClassVar[Acts] = "measurement"
    sentence: ClassVar[str] = "part of the torque that accelerates the joint is not in its reading"
    example: ClassVar[Mapping[str, Any]] = {"inertia_kgm2": 0.2}
    ambiguity: ClassVar[Ambiguity] = INERTIA
    drawing: ClassVar[Drawing] = Drawing("qdd")
    search: ClassVar[Search] = Search(in_diagnosis=False)

    kind: Literal["acceleration_reading"] = "acceleration_reading"
    inertia_kgm2: float = Field(ge=0, description="inertia whose torque is not read [kg m2]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(-s.qdd[self.index], s.q.numel())
