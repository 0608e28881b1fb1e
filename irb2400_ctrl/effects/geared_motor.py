"""A wrist motor that the axes before its own turn along."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import COUPLING, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals

AXES = 6
"""of an arm whose last three are such a wrist"""


class GearedMotor(Effect):
    """tau = e T(w) - e_j T(qd_j),  w = e^T qd,  T(w) = I dw/dt + D w + F sgn w;

    e is 1 on joint j, r on joint j - 1 and r' on joint j - 2. The hollow shafts of a wrist carry
    the motors' motion through the axes before theirs. The rotor inertia and friction of the file
    are those of joint j moving alone: I, D and F are what of them is the motor's, and so goes with
    w. Torques are those of the joints (Janot, Gautier: Staubli TX40).
    """

    sentence: ClassVar[str] = "the axes before this one turn its motor along"
    example: ClassVar[Mapping[str, Any]] = {
        "ratio": 1.0,
        "inertia_kgm2": 0.05,
        "viscous_Nms_rad": 0.5,
        "coulomb_Nm": 1.0,
    }
    ambiguity: ClassVar[Ambiguity] = COUPLING
    drawing: ClassVar[Drawing] = Drawing("qd")
    search: ClassVar[Search] = Search(in_diagnosis=False)

    kind: Literal["geared_motor"] = "geared_motor"
    ratio: float = Field(
        default=0.0,
        description="turns of the motor with the axis before, per turn with its own r [-]",
    )
    far_ratio: float = Field(default=0.0, description="the same of the axis before that r' [-]")
    inertia_kgm2: float = Field(default=0.0, description="rotor inertia I at its axis [kg m2]")
    viscous_Nms_rad: float = Field(default=0.0, description="viscous friction D [Nm s/rad]")
    coulomb_Nm: float = Field(default=0.0, description="dry friction F [Nm]")

    def basis(self, s: Signals) -> ca.SX:
        j = self.index
        turns = ca.vertcat(*self.turns(s.q.numel()))
        speed = ca.dot(turns, s.qd)
        together = (ca.dot(turns, s.qdd), speed, ca.sign(speed))
        alone = (s.qdd[j], s.qd[j], s.sign[j])
        columns: ca.SX = ca.horzcat(*(turns * signal for signal in together))
        for column, signal in enumerate(alone):
            columns[j, column] -= signal
        return columns

    def turns(self, n: int) -> tuple[Any, ...]:
        """`turns_of` this one."""
        return turns_of(self.index, (self.ratio, self.far_ratio), n)

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [{"ratio": r, "far_ratio": 0.0} for r in (-1.0, -0.5, 0.5, 1.0)]

    @classmethod
    def joints(cls, n: int) -> Sequence[int]:
        return (AXES - 1, AXES) if n == AXES else ()


def turns_of(j: int, ratios: tuple[Any, Any], n: int) -> tuple[Any, ...]:
    """e, turns of a motor per turn of each of n joints.

    Args:
        j: its own, from 0; ratios: r and r'; n: joints.
    """
    by = {j: 1.0, j - 1: ratios[0], j - 2: ratios[1]}
    return tuple(by.get(k, 0.0) for k in range(n))


def jumping(speed: Array, _acceleration: Array) -> Array:
    """Dry friction of one, as the effect has it: it jumps where a motor turns."""
    return np.sign(speed)


def along(
    motion: tuple[Array, Array],
    turns: tuple[float, ...],
    j: int,
    dry: Callable[[Array, Array], Array] = jumping,
) -> Array:
    """`GearedMotor.basis` along a motion, shape (m, n, 3): per unit of I, D and F.

    Args:
        motion: qd [rad/s] and qdd [rad/s2], (m, n) each; turns: e; j: its own joint, from 0.
        dry: of a speed and an acceleration, what dry friction of one is there.
    """
    e = np.array(turns)
    qd, qdd = motion
    found = np.empty((*qd.shape, 3))
    w = qd @ e
    dw = qdd @ e
    together = (dw, w, dry(w, dw))
    alone = (qdd[:, j], qd[:, j], dry(qd[:, j], qdd[:, j]))
    for column, (with_others, of_its_own) in enumerate(zip(together, alone, strict=True)):
        found[:, :, column] = np.outer(with_others, e)
        found[:, j, column] -= of_its_own
    return found
