"""One actuator of the robot file: its limits, its friction, its transmission.

What nobody has stated is absent from the file and `None` here: it is unknown, not zero.
"""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from irb2400_ctrl.robot.numbers import UNKNOWN, NotNegative, Positive, Range
from irb2400_ctrl.table import Table


class Friction(Table):
    """Stribeck friction of one actuator (eq. 54, Tab. 5); a term that is absent is unknown."""

    static_Nm: NotNegative | None = None
    coulomb_Nm: NotNegative | None = None
    viscous_Nms_rad: NotNegative | None = None
    stribeck_rad_s: Positive | None = None
    source: str = Field(default=UNKNOWN, min_length=1)

    def known(self) -> tuple[bool, bool, bool, bool]:
        """Which of F_s, F_c, F_v, omega_st the file states."""
        terms = (self.static_Nm, self.coulomb_Nm, self.viscous_Nms_rad, self.stribeck_rad_s)
        static, coulomb, viscous, stribeck = (term is not None for term in terms)
        return static, coulomb, viscous, stribeck


PLAUSIBLE = {
    "speed_deg_s": (1e-2, 1e5),
    "torque_Nm": (1e-4, 1e7),
    "acceleration_deg_s2": (1e-2, 1e8),
    "torque_rate_Nm_s": (1e-3, 1e12),
}
"""what an actuator of any arm has; beyond it a number is a slip, and a plan would never end"""


class Limits(Table):
    """Limits of one actuator; speed and torque may be unknown."""

    range_deg: Range
    speed_deg_s: Positive | None = None
    range_source: str = Field(min_length=1)
    torque_Nm: Positive | None = None
    torque_source: str = Field(default=UNKNOWN, min_length=1)
    acceleration_deg_s2: Positive | None = None
    torque_rate_Nm_s: Positive | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        low, high = self.range_deg
        if low >= high:
            raise ValueError(f"range_deg is [{low}, {high}], expected the lower end first")
        return self

    @model_validator(mode="after")
    def _of_an_arm(self) -> Self:
        for key, (least, most) in PLAUSIBLE.items():
            value = getattr(self, key)
            if value is not None and not least <= value <= most:
                raise ValueError(
                    f"{key} is {value:g}, expected {least:g} to {most:g}; leave it out where it is "
                    "not known"
                )
        return self


class Transmission(Table):
    """Between motor and joint; what is absent is unknown."""

    gear_ratio: float | None = None
    """motor turns per joint turn [-]; negative where they turn opposite ways"""
    torque_constant_Nm_A: Positive | None = None
    """torque of the motor per ampere, on the motor's side"""
    motor_inertia_kgm2: NotNegative | None = None
    """of rotor, brake and coupling, on the motor's side"""
    source: str = Field(min_length=1)

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if self.gear_ratio == 0:
            raise ValueError("gear_ratio is 0, expected motor turns per joint turn")
        return self

    @property
    def reflected_inertia(self) -> float | None:
        """Of the rotor on the joint's side, gear_ratio^2 motor_inertia [kg m2]; None: unknown."""
        if self.gear_ratio is None or self.motor_inertia_kgm2 is None:
            return None
        return self.gear_ratio**2 * self.motor_inertia_kgm2


class Joint(Table):
    """One actuator: friction and limits act on its own angle q."""

    name: str
    friction: Friction = Friction()
    limits: Limits
    transmission: Transmission | None = None


class MotorCoupling(Table):
    """Motors that turn several joints, as in many wrists: motor_i / gear_ratio_i = (matrix q)_i.

    Carried for logs that are recorded on the motor's side; the model is written in q.
    """

    matrix: tuple[tuple[float, ...], ...]
    source: str = Field(min_length=1)
