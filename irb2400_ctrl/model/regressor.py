"""Torque linear in the inertial parameters."""

from __future__ import annotations

import casadi as ca
import numpy as np

from irb2400_ctrl.model.bodies import parameters, pseudo_inertia
from irb2400_ctrl.model.newton_euler import inverse_dynamics
from irb2400_ctrl.robot import Robot


def regressor(
    robot: Robot, q: ca.SX, qd: ca.SX, qdd: ca.SX, gravity: ca.SX | ca.DM | None = None
) -> ca.SX:
    """Y with tau = Y phi, phi the (m, mc, I_O) of all links one after another, shape (n, 10 n);
    gravity in the base frame [m/s2], default the robot's.

    Args:
        robot: the arm.
        q: angles of the axes [rad], shape (n,), symbols.
        qd: their speeds [rad/s], shape (n,), symbols.
        qdd: their accelerations [rad/s2], shape (n,), symbols.
        gravity: [m/s2], shape (3,).
    """
    phi = ca.SX.sym("phi", 10 * robot.n)
    tau = inverse_dynamics(robot, q, qd, qdd, ca.reshape(phi, 10, robot.n).T, gravity)
    return ca.jacobian(tau, phi)


def transport(X: ca.DM) -> ca.DM:
    """T (10, 10), so that T phi are the parameters of a body in the frame that X (4, 4) leads
    to."""
    columns = [
        parameters(np.array(X @ ca.DM(ca.evalf(pseudo_inertia(unit))) @ X.T))
        for unit in ca.horzsplit(ca.DM.eye(10))
    ]
    return ca.DM(np.column_stack(columns))
