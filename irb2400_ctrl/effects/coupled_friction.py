"""Dry friction of a neighbour's motor, felt on both axes of a wrist."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import COUPLING, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals


class CoupledFriction(Effect):
    """tau_j = F_j sgn qd_k,  tau_k = F_k sgn qd_j,  k = j + 1.

    The dry part of a `wrist_coupling`, which now states it itself; robot files identified before
    hold it.
    """

    sentence: ClassVar[str] = "moving this wrist axis rubs in its neighbour's gears"
    example: ClassVar[Mapping[str, Any]] = {"here_Nm": 0.5, "neighbour_Nm": 0.5}
    ambiguity: ClassVar[Ambiguity] = COUPLING
    drawing: ClassVar[Drawing] = Drawing("qd")
    search: ClassVar[Search] = Search(in_diagnosis=False)

    kind: Literal["coupled_friction"] = "coupled_friction"
    here_Nm: float = Field(default=0.0, description="on this joint, by the next one's motion [Nm]")
    neighbour_Nm: float = Field(
        default=0.0, description="on the next joint, by this one's motion [Nm]"
    )

    def basis(self, s: Signals) -> ca.SX:
        j = self.index
        columns = ca.SX(s.q.numel(), 2)
        columns[j, 0] = ca.sign(s.qd[j + 1])
        columns[j + 1, 1] = ca.sign(s.qd[j])
        return columns

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        return range(4, n)
