"""Mechanical coupling of two wrist axes: neighbours, or the first and the third."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Literal, Self

import casadi as ca
from pydantic import Field, field_validator

from irb2400_ctrl.effects.ambiguity import COUPLING, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.coulomb_change import NEAR_REVERSAL
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals

GIVEN_BACK = 0.5
"""of the larger of two viscous couplings of opposite signs that the smaller one is at least, where
what the axes do to each other is mostly given back"""


class AxisCoupling(Effect):
    """Joint j and joint k, `along` axes further.

    The bevel gears of a wrist turn motor k when joint j moves, so its rotor inertia is felt on both
    axes, and its friction on the one whose motion it resists. One that is symmetric in its viscous
    part does not state D'.
    """

    example: ClassVar[Mapping[str, Any]] = {"inertia_kgm2": 0.05, "viscous_Nms_rad": 0.5}
    ambiguity: ClassVar[Ambiguity] = COUPLING
    # the motor's friction is no straight line over the sum of two speeds
    prior: ClassVar[Prior] = Prior(discrepancy_share=0.35)
    drawing: ClassVar[Drawing] = Drawing("qd")

    inertia_kgm2: float = Field(default=0.0, description="coupled inertia I [kg m2]")
    viscous_Nms_rad: float = Field(
        default=0.0, description="viscous friction here by the other's motion D [Nm s/rad]"
    )
    neighbour_viscous_Nms_rad: float | None = Field(
        default=None,
        description="viscous friction there by this one's motion D', absent: the same [Nm s/rad]",
    )
    dry_Nm: float = Field(default=0.0, description="dry friction here by the other's motion F [Nm]")
    neighbour_dry_Nm: float = Field(
        default=0.0, description="dry friction there by this one's motion F' [Nm]"
    )

    @classmethod
    @abstractmethod
    def along(cls) -> int:
        """How many axes further the other one is."""

    @property
    def other(self) -> int:
        """Zero-based place of k."""
        return self.index + self.along()

    @field_validator("discrepancy")
    @classmethod
    def _with_turning(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        """Files of 0.2.0 and before state the first four: their dry friction jumps."""
        return value + (0.0,) * 4 if len(value) == 4 else value

    def basis(self, s: Signals) -> ca.SX:
        j = self.index
        k = self.other
        columns = ca.SX(s.q.numel(), 5)
        columns[j, 0] = s.qdd[k]
        columns[k, 0] = s.qdd[j]
        columns[j, 1] = s.qd[k]
        columns[k, 2] = s.qd[j]
        columns[j, 3] = ca.sign(s.qd[k])
        columns[k, 4] = ca.sign(s.qd[j])
        return columns

    def discrepancy_basis(self, s: Signals) -> ca.SX:
        j = self.index
        k = self.other
        columns = ca.SX(s.q.numel(), 8)
        # action and reaction through different ratios, the motor turned along as a load of its own
        for column, signal in enumerate((s.qdd, s.qd)):
            columns[j, column] = signal[k]
            columns[k, column] = -signal[j]
            columns[j, column + 2] = signal[j]
        # dry friction that turns over as on every contact, not in a jump
        ways = ((j, k), (k, j))
        turning = [(here, other, v) for here, other in ways for v in NEAR_REVERSAL]
        for column, (here, other, v) in enumerate(turning, start=4):
            speed = s.qd[other]
            columns[here, column] = ca.sign(speed) * ca.exp(-ca.fabs(speed) / v)
        return columns

    def coefficients(self) -> tuple[float, ...]:
        there = self.neighbour_viscous_Nms_rad
        viscous = self.viscous_Nms_rad
        return (
            self.inertia_kgm2,
            viscous,
            viscous if there is None else there,
            self.dry_Nm,
            self.neighbour_dry_Nm,
        )

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        inertia, here, there, dry, neighbour_dry = coefficients
        return cls.of(
            joint,
            inertia_kgm2=inertia,
            viscous_Nms_rad=here,
            neighbour_viscous_Nms_rad=None if there == here else there,
            dry_Nm=dry,
            neighbour_dry_Nm=neighbour_dry,
        )

    @property
    def mistaken_for(self) -> str:
        """A spindle that spins up is a coupling of axes to whoever knows no gyroscopic moments.

        Its moment takes no work out of the axes, (D + D') qd_j qd_k is nothing, and begins as it is
        switched on; gears do, and are there from the start.
        """
        _, here, there, _, _ = self.coefficients()
        sizes = sorted((abs(here), abs(there)))
        which = f"joint {self.joint}: what this axis and joint {self.other + 1} do to each other"
        if here * there < 0.0 and sizes[0] >= GIVEN_BACK * sizes[1]:
            return (
                f"{which} takes hardly any work out of them, as the gyroscopic moment of a spindle "
                "that turns; the friction of gears does"
            )
        if self.windows_s and self.windows_s[0][0] > 0.0:
            return (
                f"{which} begins at {self.windows_s[0][0]:.1f} s, as the gyroscopic moment of a "
                "spindle that is switched on; gears are there from the start"
            )
        return ""

    @classmethod
    def joints(cls, n: int) -> Sequence[int]:
        return range(4, n + 1 - cls.along())


class WristCoupling(AxisCoupling):
    """tau_j = I qdd_k + D qd_k + F sgn qd_k,  tau_k = I qdd_j + D' qd_j + F' sgn qd_j,
    k = j + 1."""

    sentence: ClassVar[str] = "moving this wrist axis drags its neighbour's motor along"

    kind: Literal["wrist_coupling"] = "wrist_coupling"

    @classmethod
    def along(cls) -> int:
        return 1


class FarWristCoupling(AxisCoupling):
    """tau_j = I qdd_k + D qd_k + F sgn qd_k,  tau_k = I qdd_j + D' qd_j + F' sgn qd_j,  k = j + 2.

    The shaft of axis 6 runs through those of axes 4 and 5.
    """

    sentence: ClassVar[str] = "moving this wrist axis drags the motor of the next but one along"
    search: ClassVar[Search] = Search(beside="wrist_coupling")

    kind: Literal["far_wrist_coupling"] = "far_wrist_coupling"

    @classmethod
    def along(cls) -> int:
        return 2
