"""Mass matrix by the composite-rigid-body algorithm, and the solve with it."""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.model.kinematics import joint_transforms
from irb2400_ctrl.model.newton_euler import symmetric
from irb2400_ctrl.robot import Robot


def mass_matrix(robot: Robot, q: ca.SX, phi: ca.SX | ca.DM | None = None) -> ca.SX:
    """M(q) = A^T M_theta A (eq. 50), shape (n, n) [kg m2].

    Composite bodies are gathered from the tip: mass, first moment and inertia about each joint's origin. Column i is
    the wrench of composite body i under unit acceleration of joint i, carried down to the joints below it.
    """
    n = robot.n
    phi = ca.DM(robot.inertial_parameters) if phi is None else phi
    A = ca.DM(robot.A)
    transforms = joint_transforms(robot, q)
    M = ca.SX(n, n)
    mass, moment, inertia = ca.SX(0), ca.SX(3, 1), ca.SX(3, 3)
    for i in reversed(range(n)):
        mass, moment = mass + phi[i, 0], moment + phi[i, 1:4].T
        inertia = inertia + symmetric(phi[i, 4:10])
        # unit acceleration about z: force z x mc, moment I z
        f = ca.vertcat(-moment[1], moment[0], 0)
        torque = inertia[:, 2]
        M[i, i] = torque[2]
        for j in reversed(range(i)):
            R, p = transforms[j + 1]
            f, torque = R @ f, R @ torque
            torque = torque + ca.cross(p, f)
            M[i, j] = M[j, i] = torque[2]
        R, p = transforms[i]
        moment, inertia = _carried(R, p, mass, moment, inertia)
    return A.T @ M @ A


def _carried(R: ca.SX, p: ca.SX, mass: ca.SX, moment: ca.SX, inertia: ca.SX) -> tuple[ca.SX, ca.SX]:
    """First moment and inertia about the parent's origin, in the parent's frame."""
    turned = R @ moment
    shift = 2 * ca.dot(p, turned) * ca.SX.eye(3) - p @ turned.T - turned @ p.T
    shift += mass * (ca.dot(p, p) * ca.SX.eye(3) - p @ p.T)
    carried = R @ inertia @ R.T + shift
    return turned + mass * p, carried


def solve_ldl(M: ca.SX, b: ca.SX) -> ca.SX:
    """x with M x = b by an unrolled LDL^T factorisation; M symmetric positive definite, shape (n, n)."""
    n = M.shape[0]
    L, D = ca.SX.eye(n), [ca.SX(0)] * n
    for j in range(n):
        scaled = [L[j, k] * D[k] for k in range(j)]
        D[j] = M[j, j] - sum((L[j, k] * scaled[k] for k in range(j)), ca.SX(0))
        for i in range(j + 1, n):
            L[i, j] = (M[i, j] - sum((L[i, k] * scaled[k] for k in range(j)), ca.SX(0))) / D[j]
    x: list[ca.SX] = []
    for i in range(n):
        x.append(b[i] - sum((L[i, k] * x[k] for k in range(i)), ca.SX(0)))
    x = [value / d for value, d in zip(x, D, strict=True)]
    for i in reversed(range(n)):
        x[i] = x[i] - sum((L[k, i] * x[k] for k in range(i + 1, n)), ca.SX(0))
    return ca.vertcat(*x)
