"""The same dynamics by the Euler-Lagrange formalism (eqs. 44-56): the second, independent
derivation.

Nothing here uses the Newton-Euler recursion: energies from the centre-of-mass Jacobians, M from
their sum (eq. 50), Coriolis terms from the Christoffel symbols (eq. 51), gravity from the
potential's gradient (eq. 52). It is slow to evaluate and exists to check the recursion and to give
C(q, qd) in its passive form (Mdot - 2C skew).
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from irb2400_ctrl.model.kinematics import link_poses, point_jacobian
from irb2400_ctrl.robot import Robot


def mass_matrix(robot: Robot, q: ca.SX) -> ca.SX:
    """M = sum m J_v^T J_v + J_w^T R I R^T J_w (eq. 50), shape (n, n) [kg m2]."""
    M = ca.SX(robot.n, robot.n)
    for link, mass, com, tensor, X in _bodies(robot, q):
        R = X[:3, :3]
        J = point_jacobian(robot, q, X[:3, 3] + R @ ca.DM(com), link)
        J_v = J[:3, :]
        J_w = J[3:, :]
        M += mass * J_v.T @ J_v + J_w.T @ R @ ca.DM(tensor) @ R.T @ J_w
    return M


def coriolis(robot: Robot, q: ca.SX, qd: ca.SX) -> ca.SX:
    """C(q, qd) from the Christoffel symbols (eq. 51), shape (n, n); C qd is the Coriolis and
    centrifugal torque.

    Args:
        robot: the arm, tool in its last link.
        q: angles of the axes [rad], shape (n,), symbols.
        qd: their speeds [rad/s], shape (n,), symbols.
    """
    n = robot.n
    M = mass_matrix(robot, q)
    dM = [ca.reshape(ca.jacobian(M, q[i]), n, n) for i in range(n)]
    C = ca.SX(n, n)
    for k in range(n):
        for j in range(n):
            C[k, j] = sum(0.5 * (dM[i][k, j] + dM[j][k, i] - dM[k][i, j]) * qd[i] for i in range(n))
    return C


def potential(robot: Robot, q: ca.SX) -> ca.SX:
    """P = -sum m g . o_S (eq. 48 with g the gravity vector, pointing down) [J]."""
    P = ca.SX(0)
    for _, mass, com, _, X in _bodies(robot, q):
        P -= mass * ca.dot(ca.DM(robot.gravity), X[:3, 3] + X[:3, :3] @ ca.DM(com))
    return P


def kinetic(robot: Robot, q: ca.SX, qd: ca.SX) -> ca.SX:
    """K = sum (m v^2 + w^T R I R^T w) / 2 (eq. 46), v = J_v qd and w = J_w qd of each body (eq. 47)
    [J].

    Args:
        robot: the arm, tool in its last link.
        q: angles of the axes [rad], shape (n,), symbols.
        qd: their speeds [rad/s], shape (n,), symbols.
    """
    K = ca.SX(0)
    for link, mass, com, tensor, X in _bodies(robot, q):
        R = X[:3, :3]
        twist = point_jacobian(robot, q, X[:3, 3] + R @ ca.DM(com), link) @ qd
        v = twist[:3]
        w = R.T @ twist[3:]
        K += 0.5 * (mass * ca.dot(v, v) + ca.dot(w, ca.DM(tensor) @ w))
    return K


def lagrange_equation(robot: Robot, q: ca.SX, qd: ca.SX, qdd: ca.SX) -> ca.SX:
    """Generalised force d/dt (dL/dqd) - dL/dq (eq. 44) of L = K - P (eq. 45), shape (n,) [Nm].

    Straight from the energies, without M, C and G; equal to them (eq. 49).

    Args:
        robot: the arm, tool in its last link.
        q: angles of the axes [rad], shape (n,), symbols.
        qd: their speeds [rad/s], shape (n,), symbols.
        qdd: their accelerations [rad/s2], shape (n,), symbols.
    """
    L = kinetic(robot, q, qd) - potential(robot, q)
    momentum = ca.gradient(L, qd)
    rate = ca.jtimes(momentum, ca.vertcat(q, qd), ca.vertcat(qd, qdd))
    return rate - ca.gradient(L, q)


def gravity(robot: Robot, q: ca.SX) -> ca.SX:
    """G = (dP / dq)^T (eq. 52), shape (n,) [Nm]."""
    return ca.gradient(potential(robot, q), q)


def _bodies(robot: Robot, q: ca.SX) -> list[tuple[int, float, np.ndarray, np.ndarray, ca.SX]]:
    """(link number, mass, centre of mass, tensor about it, pose) of every body; the tool rides on
    the flange."""
    poses = link_poses(robot, q)
    bodies = [
        (i + 1, link.body.mass_kg, np.array(link.body.com_m), link.body.tensor(), poses[i])
        for i, link in enumerate(robot.links)
    ]
    if robot.tool is not None:
        body = robot.tool.body
        X_BF = poses[-1] @ ca.SX(ca.DM(robot.flange.matrix()))
        bodies.append((robot.n, body.mass_kg, np.array(body.com_m), body.tensor(), X_BF))
    return bodies
