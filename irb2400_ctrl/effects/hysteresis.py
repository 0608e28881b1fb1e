"""Hysteresis of the transmission: friction that builds up over a small angle after each
reversal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field, model_validator

from irb2400_ctrl.effects.ambiguity import REVERSAL, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals

SHAPE = 0.03
"""`Prior.departure`: another way of building up is seen behind turns alone"""


class Hysteresis(Effect):
    """tau_j = A z - R sgn qd_j,  dz/dt = (qd_j - |qd_j| z) / width  (Dahl model; z -> sgn(qd_j)
    after a few widths).

    R = 0 is a loop on top of the joint's dry friction; R = A the joint's own dry friction that
    builds up over an angle instead of jumping. What it may be off that is another way of building
    up, to the same height: z |z| - z and z^3 - z.
    """

    sentence: ClassVar[str] = (
        "after each reversal the friction of the joint builds up over a small angle"
    )
    example: ClassVar[Mapping[str, Any]] = {"amplitude_Nm": 1.0, "width_rad": 0.02}
    ambiguity: ClassVar[Ambiguity] = REVERSAL
    prior: ClassVar[Prior] = Prior(in_place_of_friction=("replaced_Nm",), departure=SHAPE)
    search: ClassVar[Search] = Search(turns_over_in="width_rad")
    drawing: ClassVar[Drawing] = Drawing("qd")
    states: ClassVar[tuple[str, ...]] = ("z",)

    kind: Literal["hysteresis"] = "hysteresis"
    amplitude_Nm: float = Field(ge=0, description="half height of the loop A [Nm]")
    width_rad: float = Field(gt=0, description="angle over which the loop builds up [rad]")
    replaced_Nm: float = Field(
        default=0.0, description="dry friction R of the joint that the loop takes the place of [Nm]"
    )

    @model_validator(mode="before")
    @classmethod
    def _of_its_height(cls, given: Any) -> Any:
        """Files of earlier versions have z |z|, a part of the loop's height."""
        if not isinstance(given, Mapping):
            return given
        name = "shape" if "shape" in given else "discrepancy"
        off = given.get(name, ())
        height = given.get("amplitude_Nm")
        if not (isinstance(off, (list, tuple)) and len(off) == 1):
            return given
        if not (isinstance(off[0], (int, float)) and isinstance(height, (int, float))):
            return given
        return {**given, "amplitude_Nm": height + off[0], name: (off[0], 0.0)}

    def basis(self, s: Signals) -> ca.SX:
        n = s.q.numel()
        return ca.horzcat(self.on(s.state[0], n), self.on(-s.sign[self.index], n))

    @property
    def unlikely(self) -> bool:
        # beyond that it is a change of the dry friction; of many sliders most may turn over at once
        return not -2.5 < self.replaced_Nm / max(self.amplitude_Nm, 1e-9) < 1.5

    def state_rate(self, s: Signals) -> ca.SX:
        speed = s.qd[self.index]
        return (speed - ca.fabs(speed) * s.state[0]) / self.width_rad

    def steady_state(self, s: Signals) -> ca.SX:
        return s.sign[self.index]

    def settled(self, turned: ca.SX) -> tuple[ca.SX, ca.SX]:
        # 1 - z falls to its e-th part over each width; z stays between -1 and 1
        return 1 - 2 * ca.exp(-turned / self.width_rad), ca.SX(1.0)

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        z = s.state[0]
        n = s.q.numel()
        return ca.horzcat(self.on(z * ca.fabs(z) - z, n), self.on(z**3 - z, n))

    def sizes(self) -> tuple[float, ...]:
        return (self.amplitude_Nm,)

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        # a loop on top of the dry friction has no second one
        amplitude, replaced = (*coefficients, 0.0)[:2]
        return cls.of(joint, amplitude_Nm=amplitude, replaced_Nm=replaced, **nonlinear)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [{"width_rad": float(w)} for w in np.geomspace(0.00125, 0.16, 15)]
