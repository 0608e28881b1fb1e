"""Force of the process (milling, contact, a pulling hose) at the tool."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import TOOL, Ambiguity
from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.drawing import Drawing
from irb2400_ctrl.effects.prior import Nested, Prior
from irb2400_ctrl.effects.search import Search
from irb2400_ctrl.effects.signals import Signals

FORCE = ("force_x_N", "force_y_N", "force_z_N")
MOMENT = ("moment_x_Nm", "moment_y_Nm", "moment_z_Nm")
FEW = 3
"""pushes, from which on they may be a load that swings"""
SHORT = 1.0
"""[s]"""
UNLIKE = 2.0
"""times as long the longest is as the shortest"""
A_MOMENT = 0.2
"""[s], as long as readings may stand still"""


class ProcessForce(Effect):
    """tau = -J_v(q)^T F - J_w(q)^T M while start_s <= t < stop_s; F acts on the tool, constant
    along the axes of the base, or of the tool (F = R_BT(q) F_T), and so does M, which is c x F
    where F acts at c beside the tool centre point."""

    sentence: ClassVar[str] = "something pushes or pulls at the tool"
    example: ClassVar[Mapping[str, Any]] = {"force_x_N": 30.0, "force_y_N": 20.0, "force_z_N": 40.0}
    ambiguity: ClassVar[Ambiguity] = replace(TOOL, time_matters=True)
    prior: ClassVar[Prior] = Prior(fixed=("start_s", "stop_s"), absent=MOMENT)
    search: ClassVar[Search] = Search(comes_and_goes=True)
    drawing: ClassVar[Drawing] = Drawing("time")
    whole_arm: ClassVar[bool] = True

    kind: Literal["process_force"] = "process_force"
    force_x_N: float = Field(default=0.0, description="force on the tool along x [N]")
    force_y_N: float = Field(default=0.0, description="force on the tool along y [N]")
    force_z_N: float = Field(default=0.0, description="force on the tool along z [N]")
    moment_x_Nm: float = Field(default=0.0, description="moment on the tool about x [Nm]")
    moment_y_Nm: float = Field(default=0.0, description="moment on the tool about y [Nm]")
    moment_z_Nm: float = Field(default=0.0, description="moment on the tool about z [Nm]")
    in_tool_frame: bool = Field(
        default=False, description="whether x, y, z are the axes of the tool, not of the base [-]"
    )
    start_s: float = Field(default=0.0, description="first instant of the force [s]")
    stop_s: float = Field(default=1e9, description="end of the force [s]")

    def basis(self, s: Signals) -> ca.SX:
        active = ca.logic_and(s.time >= self.start_s, s.time < self.stop_s)
        turned = self.in_tool_frame * s.tool_axes
        held = (1 - self.in_tool_frame) * ca.SX.eye(3)
        axes = turned + held
        return -active * s.tcp_jacobian.T @ ca.diagcat(axes, axes)

    @classmethod
    def nested(cls, mass: float, reach: float, axis: Array) -> Sequence[Nested]:
        """A force alone, or with its lever.

        Args:
            mass: that the arm moves [kg]; reach: of its flange [m]; axis: of its last joint.
        """
        # at the tool centre point, or anywhere
        return [Nested(np.eye(6)[:, :k], ()) for k in (3, 6)]

    @classmethod
    def grid(cls, joint: int | None) -> list[dict[str, float]]:
        return [{"in_tool_frame": False}, {"in_tool_frame": True}]

    @classmethod
    def representative(cls, joint: int | None, inertia: float, duration: float) -> Self:
        # it comes and goes within the motion
        return cls.of(joint, **cls.example, start_s=0.3 * duration, stop_s=0.7 * duration)

    @property
    def mistaken_for(self) -> str:
        """A liquid at the tool and a load that knocks in its grip were forces of many short pushes
        of unlike lengths, at 0.86 to 0.94; cuts and contacts last longer, or one like the other.
        Torques that stood still for 0.06 s and 0.15 s were forces at 0.96 and 0.98."""
        lasting = [stop - start for start, stop in self.windows_s]
        if lasting and max(lasting) < A_MOMENT:
            return (
                f"{self.kind} at {self.windows_s[0][0]:.1f} s: it lasts {max(lasting):.2f} s, and "
                "for so long readings may stand still, too: look at the torques there as they were "
                "recorded"
            )
        if len(lasting) < FEW or min(lasting) > SHORT or max(lasting) < UNLIKE * min(lasting):
            return ""
        return (
            f"{self.kind}: {len(lasting)} pushes, some of them short, and of unlike lengths: what "
            "swings or is loose at the tool makes such, too; stop the arm in the middle of a "
            "motion and see whether the torques go on"
        )

    def coefficients(self) -> tuple[float, ...]:
        force = (self.force_x_N, self.force_y_N, self.force_z_N)
        return (*force, self.moment_x_Nm, self.moment_y_Nm, self.moment_z_Nm)

    def sizes(self) -> tuple[float, ...]:
        return (math.hypot(self.force_x_N, self.force_y_N, self.force_z_N),)

    @property
    def lever_m(self) -> float:
        """How far from the tool centre point the force acts at least, infinity of a moment alone
        [m]."""
        moment = math.hypot(self.moment_x_Nm, self.moment_y_Nm, self.moment_z_Nm)
        (force,) = self.sizes()
        if not force:
            return math.inf if moment else 0.0
        return moment / force

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        wrench = dict(zip((*FORCE, *MOMENT), coefficients, strict=True))
        return cls.of(joint, **wrench, **nonlinear)
