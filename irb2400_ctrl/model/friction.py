"""Friction of the actuators (eqs. 54, 55)."""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.robot import Robot


def friction(
    robot: Robot, qd: ca.SX, sign: ca.SX | None = None, table: ca.SX | ca.DM | None = None
) -> ca.SX:
    """F = (F_c + (F_s - F_c) exp(-|qd / omega_st|^2)) sgn(qd) + F_v qd (eq. 55), shape (n,) [Nm].

    Args:
        qd: actuator speeds [rad/s], shape (n,).
        sign: direction of motion to use for sgn(qd): a regularised sign, or the intended direction
            at rest.
        table: columns F_s, F_c, F_v, omega_st, shape (n, 4); default those of the robot.
    """
    sign = ca.sign(qd) if sign is None else sign
    static, coulomb, viscous, stribeck = ca.horzsplit(
        ca.DM(robot.friction) if table is None else table
    )
    return (coulomb + (static - coulomb) * ca.exp(-((qd / stribeck) ** 2))) * sign + viscous * qd
