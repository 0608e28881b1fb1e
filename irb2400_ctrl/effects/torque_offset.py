"""Constant offset of the torque reading."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import OFFSET, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import EXACT, Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class TorqueOffset(Effect):
    """measured tau_j = tau_j + offset."""

    acts: ClassVar[Acts] = "measurement"
    sentence: ClassVar[str] = "the reported torque of the joint is shifted by a constant"
    example: ClassVar[Mapping[str, Any]] = {"offset_Nm": 1.0}
    ambiguity: ClassVar[Ambiguity] = OFFSET
    prior: ClassVar[Prior] = Prior(discrepancy_share=EXACT, lasting=0)
    # a drive's amplifiers drift alike
    search: ClassVar[Search] = Search(on_every_joint=True, usual=True)
    drawing: ClassVar[Drawing] = Drawing("time")

    kind: Literal["torque_offset"] = "torque_offset"
    offset_Nm: float = Field(description="offset [Nm]")

    def basis(self, s: Signals) -> ca.SX:
        return self.on(ca.SX(1.0), s.q.numel())

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        # an amplifier that warms up drifts
        return self.on(s.time, s.q.numel())

    def _shown(self, time: Array, tau: Array) -> Array:
        shown = np.array(tau)
        shown[:, self.index] += self.offset_Nm + sum(self.discrepancy) * time
        return shown
