"""Base that is not level."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import casadi as ca
from pydantic import Field

from irb2400_ctrl.effects.ambiguity import BASE, Ambiguity
from irb2400_ctrl.effects.base import STANDARD_GRAVITY, Acts, Effect
from irb2400_ctrl.effects.prior import Prior
from irb2400_ctrl.effects.signals import Signals


class BaseTilt(Effect):
    """Gravity (g_x, g_y) = 9.81 (tilt_y, -tilt_x) in the base frame, small angles: tau = (d tau / d
    g) g."""

    acts: ClassVar[Acts] = "force"
    sentence: ClassVar[str] = "the base of the robot is not level"
    example: ClassVar[Mapping[str, Any]] = {"tilt_x_rad": 0.01, "tilt_y_rad": 0.01}
    ambiguity: ClassVar[Ambiguity] = BASE
    # the law is exact for the masses of the arm; those of the file are off by some per cent
    prior: ClassVar[Prior] = Prior(discrepancy_share=0.05)
    whole_arm: ClassVar[bool] = True

    kind: Literal["base_tilt"] = "base_tilt"
    tilt_x_rad: float = Field(
        default=0.0, description="rotation of the base about its x axis [rad]"
    )
    tilt_y_rad: float = Field(
        default=0.0, description="rotation of the base about its y axis [rad]"
    )

    def basis(self, s: Signals) -> ca.SX:
        g_x = s.gravity_map[:, 0]
        g_y = s.gravity_map[:, 1]
        # a base turned by a small angle t about x sees gravity R^T g: g_y = -9.81 * t (about y: g_x
        # = +9.81 * t)
        return STANDARD_GRAVITY * ca.horzcat(-g_y, g_x)
