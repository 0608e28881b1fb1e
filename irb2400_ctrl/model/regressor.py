"""Torque linear in the inertial parameters."""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.model.newton_euler import inverse_dynamics, symmetric
from irb2400_ctrl.robot import Robot


def regressor(robot: Robot, q: ca.SX, qd: ca.SX, qdd: ca.SX) -> ca.SX:
    """Y with tau = Y phi, phi the (m, mc, I_O) of all links one after another, shape (n, 10 n)."""
    phi = ca.SX.sym("phi", 10 * robot.n)
    tau = inverse_dynamics(robot, q, qd, qdd, phi=ca.reshape(phi, 10, robot.n).T)
    return ca.jacobian(tau, phi)


def transport(X: ca.DM) -> ca.DM:
    """T (10, 10), so that T phi are the parameters of a body in the frame that X (4, 4) leads to.

    The pseudo-inertia [[Sigma, mc], [mc^T, m]], Sigma = tr(I)/2 1 - I, moves as X J X^T.
    """
    phi = ca.SX.sym("phi", 10)
    inertia, mc = symmetric(phi[4:10]), phi[1:4]
    J = ca.vertcat(ca.horzcat(ca.trace(inertia) / 2 * ca.SX.eye(3) - inertia, mc), ca.horzcat(mc.T, phi[0]))
    J = X @ J @ X.T
    Sigma = J[:3, :3]
    moved = ca.trace(Sigma) * ca.SX.eye(3) - Sigma
    six = [moved[i, j] for i in range(3) for j in range(i, 3)]
    return ca.DM(ca.evalf(ca.jacobian(ca.vertcat(J[3, 3], J[:3, 3], *six), phi)))
