"""Inverse dynamics by the Newton-Euler recursion (eqs. 57-68).

The recursion carries first moments and inertias about the link frames' origins, which is the same physics as eqs.
58-61 about the centres of mass with fewer operations:

    f_i = m a_i + eps_i x mc + w_i x (w_i x mc)                       (eqs. 58, 60, 68)
    n_i = I_O eps_i + w_i x (I_O w_i) + mc x a_i                      (eqs. 59, 61)

Gravity enters as an upward acceleration of the base (eq. 64). tau_theta_i = z_i . n_i and tau = A^T tau_theta, because
the actuators turn theta = A q + offset.
"""

from __future__ import annotations

import casadi as ca

from irb2400_ctrl.model.kinematics import joint_transforms, skew
from irb2400_ctrl.robot import Robot


def inverse_dynamics(
    robot: Robot,
    q: ca.SX,
    qd: ca.SX,
    qdd: ca.SX,
    phi: ca.SX | ca.DM | None = None,
    gravity: ca.SX | ca.DM | None = None,
) -> ca.SX:
    """Rigid-body torque of the actuators, no friction, no effects, shape (n,) [Nm].

    Args:
        q, qd, qdd: actuator angles, speeds, accelerations [rad, rad/s, rad/s2], shape (n,).
        phi: inertial parameters (m, mc, I_O) of each link, shape (n, 10); default those of the robot.
        gravity: gravity in the base frame [m/s2], shape (3,); default the robot's.
    """
    n = robot.n
    phi = ca.DM(robot.inertial_parameters) if phi is None else phi
    gravity = ca.DM(robot.gravity) if gravity is None else gravity
    A = ca.DM(robot.A)
    rate, rate2 = A @ qd, A @ qdd
    z = ca.DM([0, 0, 1])

    transforms = joint_transforms(robot, q)
    w, eps, a = ca.SX(3, 1), ca.SX(3, 1), ca.SX(-gravity)
    forces, moments = [], []
    for i, (R, p) in enumerate(transforms):
        a = R.T @ (a + ca.cross(eps, p) + ca.cross(w, ca.cross(w, p)))
        w_parent = R.T @ w
        w = w_parent + rate[i] * z
        eps = R.T @ eps + rate2[i] * z + ca.cross(w_parent, rate[i] * z)
        m, mc, inertia = phi[i, 0], phi[i, 1:4].T, symmetric(phi[i, 4:10])
        forces.append(m * a + ca.cross(eps, mc) + ca.cross(w, ca.cross(w, mc)))
        moments.append(inertia @ eps + ca.cross(w, inertia @ w) + ca.cross(mc, a))

    tau_theta = ca.SX(n, 1)
    f, moment = ca.SX(3, 1), ca.SX(3, 1)
    for i in reversed(range(n)):
        f, moment = f + forces[i], moment + moments[i]
        tau_theta[i] = moment[2]
        R, p = transforms[i]
        f, moment = R @ f, R @ moment
        moment += ca.cross(p, f)
    return A.T @ tau_theta


def symmetric(six: ca.SX | ca.DM) -> ca.SX:
    """Tensor (3, 3) from (xx, xy, xz, yy, yz, zz)."""
    xx, xy, xz, yy, yz, zz = (six[k] for k in range(6))
    return ca.SX(ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz)))


def body_wrench(w: ca.SX, eps: ca.SX, a: ca.SX) -> ca.SX:
    """d (f, n) / d phi of a body that moves with w, eps, and acceleration a of its origin, shape (6, 10)."""
    L = inertia_map
    linear = ca.horzcat(a, skew(eps) + skew(w) @ skew(w), ca.SX(3, 6))
    angular = ca.horzcat(ca.SX(3, 1), -skew(a), L(eps) + skew(w) @ L(w))
    return ca.vertcat(linear, angular)


def inertia_map(v: ca.SX) -> ca.SX:
    """L(v), shape (3, 6), so that I v = L(v) (xx, xy, xz, yy, yz, zz)."""
    x, y, z = v[0], v[1], v[2]
    return ca.vertcat(
        ca.horzcat(x, y, z, 0, 0, 0),
        ca.horzcat(0, x, 0, y, z, 0),
        ca.horzcat(0, 0, x, 0, y, z),
    )
