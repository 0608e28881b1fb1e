"""Friction of the actuators (eqs. 54, 55)."""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.robot import Robot


def friction(robot: Robot, qd: ca.SX, sign: ca.SX | None = None) -> ca.SX:
    """F = (F_c + (F_s - F_c) exp(-|qd / omega_st|^2)) sgn(qd) + F_v qd (eq. 55), shape (n,) [Nm].

    Args:
        qd: actuator speeds [rad/s], shape (n,).
        sign: direction of motion to use for sgn(qd): a regularised sign, or the intended direction at rest.
    """
    sign = ca.sign(qd) if sign is None else sign
    static, coulomb, viscous, stribeck = (ca.DM(column) for column in robot.friction.T)
    return (coulomb + (static - coulomb) * ca.exp(-((qd / stribeck) ** 2))) * sign + viscous * qd
