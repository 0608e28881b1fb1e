"""Friction of the actuators (eqs. 54, 55): one law for plant, model, controllers, planners and
diagnosis."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Self

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.robot import Robot

_SYMBOLIC = (ca.SX, ca.MX, ca.DM)
# dry friction turns over within this speed [rad/s], and what the joint gains in this time [s]
_TURN_SPEED = 0.005
_TURN_TIME = 0.005


@dataclass(frozen=True, eq=False)
class FrictionLaw:
    """F = (F_c + (F_s - F_c) exp(-|qd / omega_st|^2)) sgn(qd) + F_v qd (eq. 55) [Nm].

    The first term is dry friction: its size is the `level`. Each number may be an array (n,), one
    of shape (…, n) that broadcasts against the speeds, or a CasADi column; speeds may be arrays
    (…, n) or CasADi columns.
    """

    static: Any
    """F_s [Nm]"""
    coulomb: Any
    """F_c [Nm]"""
    viscous: Any
    """F_v [Nm s/rad]"""
    stribeck: Any
    """omega_st [rad/s]"""

    @classmethod
    def of(cls, robot: Robot) -> Self:
        """The friction of a robot."""
        return cls.of_table(robot.friction)

    @classmethod
    def of_table(cls, table: Array | ca.SX | ca.DM) -> Self:
        """From the columns F_s, F_c, F_v, omega_st of a table, shape (n, 4)."""
        if isinstance(table, _SYMBOLIC):
            return cls(*ca.horzsplit(table))
        return cls(*table.T)

    @property
    def rise(self) -> Any:
        """F_s - F_c [Nm]: by how much dry friction is higher at rest than in motion."""
        return self.static - self.coulomb

    # ---- the law

    def level(self, qd: Any) -> Any:
        """Size of dry friction at the speeds qd [Nm]."""
        law = self._like(qd)
        return law.coulomb + law.rise * _exp(-((qd / law.stribeck) ** 2))

    def dry(self, qd: Any, sign: Any = None) -> Any:
        """Dry friction, level(qd) sgn(qd) [Nm].

        Args:
            qd: actuator speeds [rad/s].
            sign: direction of motion to use for sgn(qd): a regularised sign, or the intended
                direction at rest.
        """
        return self.level(qd) * (_sign(qd) if sign is None else sign)

    def torque(self, qd: Any, sign: Any = None) -> Any:
        """Dry and viscous friction [Nm]; arguments as in `dry`."""
        return self.dry(qd, sign) + self._like(qd).viscous * qd

    def regressor(self, qd: Array) -> tuple[Array, Array, Array]:
        """dF / d(F_c, F_v, F_s) of each joint, shapes (…, n): F is linear in these numbers."""
        sign = np.sign(qd)
        peak = sign * np.exp(-((qd / self.stribeck) ** 2))
        return sign - peak, qd, peak

    # ---- bounds

    def level_range(self, slowest_squared: Array) -> tuple[Array, Array]:
        """Least and largest size of dry friction at all speeds with qd^2 >= slowest_squared
        [rad2/s2], in this order [Nm]."""
        peak = np.exp(-slowest_squared / self.stribeck**2)
        largest = self.coulomb + np.maximum(self.rise, 0.0) * peak
        return np.minimum(self.static, self.coulomb), largest

    def dry_range(
        self, slowest_squared: Array, forwards: Mask, backwards: Mask
    ) -> tuple[Array, Array]:
        """Least and largest dry friction, sign included, of joints that move forwards, backwards,
        both or not at all [Nm]; speeds as in `level_range`.

        Args:
            slowest_squared: least squared speed [rad2/s2], shape (…, n).
            forwards: whether the joint may move forwards, same shape.
            backwards: whether it may move backwards, same shape.
        """
        least, largest = self.level_range(slowest_squared)
        # moving one way alone, friction always helps the other side by a little
        top = np.where(forwards, largest, np.where(backwards, -least, 0.0))
        bottom = np.where(backwards, -largest, np.where(forwards, least, 0.0))
        return bottom, top

    # ---- smoothed

    def smoothed(self, qd: ca.SX, width: Any) -> Any:
        """Coulomb friction whose sign turns over between about -width and width [rad/s]."""
        return self._like(qd).coulomb * ca.tanh(2 * qd / width)

    def worst(self, qd: ca.SX, width: Any) -> Any:
        """The largest dry friction, to some per cent, of a joint whose speed may be off by `width`
        [rad/s], as a smooth function; the least is -worst(-qd)."""
        law = self._like(qd)
        peak = ca.fmax(law.rise, 0) * ca.exp(-((qd / width) ** 2))
        return law.coulomb * ca.tanh(2 * qd / width + 2) + peak

    def reversal_rate(self, qd: ca.SX, qdd: ca.SX) -> Any:
        """Rate of Coulomb friction [Nm/s], its jump at a reversal spread over about 10 ms."""
        width = _TURN_SPEED + _TURN_TIME * ca.fabs(qdd)
        steep = ca.cosh(ca.fmin(ca.fabs(qd / width), 30.0)) ** 2
        return self._like(qd).coulomb * qdd / width / steep

    def _like(self, qd: Any) -> Self:
        """The same numbers as CasADi columns where the speeds are CasADi's."""
        if not isinstance(qd, _SYMBOLIC):
            return self
        own = (getattr(self, field.name) for field in fields(self))
        return type(self)(*(v if isinstance(v, _SYMBOLIC) else ca.DM(v) for v in own))


def _exp(x: Any) -> Any:
    return ca.exp(x) if isinstance(x, _SYMBOLIC) else np.exp(x)


def _sign(x: Any) -> Any:
    return ca.sign(x) if isinstance(x, _SYMBOLIC) else np.sign(x)
