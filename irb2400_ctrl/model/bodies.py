"""Mass data as pseudo-inertias, and the regrouping that leaves the torque unchanged with the fewest
numbers.

The pseudo-inertia of a body about its link's origin is the second moment of (r, 1):

    J = [[Sigma, m c], [m c^T, m]],    Sigma = tr(I)/2 1 - I = integral of r r^T dm,

and moves to another frame as X J X^T. The entries of J in rows and columns (z, 1), that is
Sigma_zz, m c_z and m, look the same at every angle of a joint that turns about z and have no
inertia against that turn: this part of a body may ride on the link before. Done from the tip to the
base this leaves each link seven numbers and the first link one: the 36 base parameters of a
six-axis arm, with which the recursions multiply by zeros that vanish.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.robot import Robot


def pseudo_inertia(phi: ca.SX | ca.DM) -> ca.SX:
    """J (4, 4) of phi = (m, m c, I_O), I_O = (xx, xy, xz, yy, yz, zz)."""
    m = phi[0]
    x = phi[1]
    y = phi[2]
    z = phi[3]
    xx, xy, xz, yy, yz, zz = (phi[k] for k in range(4, 10))
    return ca.SX(
        ca.vertcat(
            ca.horzcat((yy + zz - xx) / 2, -xy, -xz, x),
            ca.horzcat(-xy, (xx + zz - yy) / 2, -yz, y),
            ca.horzcat(-xz, -yz, (xx + yy - zz) / 2, z),
            ca.horzcat(x, y, z, m),
        )
    )


def parameters(J: Array) -> Array:
    """phi of a pseudo-inertia (inverse of `pseudo_inertia`), shape (10,)."""
    Sigma = J[:3, :3]
    inertia = np.trace(Sigma) * np.eye(3) - Sigma
    return np.array([J[3, 3], *J[:3, 3], *inertia[np.triu_indices(3)]])


def regrouped(robot: Robot, phi: Array) -> list[Array]:
    """Pseudo-inertias with the same torque in every motion, as many entries zero as can be; (4, 4)
    each."""
    bodies = [np.array(ca.evalf(pseudo_inertia(ca.DM(row)))) for row in phi]
    axial = np.ix_([2, 3], [2, 3])
    for i in reversed(range(robot.n)):
        part = np.zeros((4, 4))
        part[axial] = bodies[i][axial]
        bodies[i][axial] = 0.0
        if i > 0:
            X = robot.links[i].frame.matrix()
            bodies[i - 1] += X @ part @ X.T
    # the first link turns about a fixed axis: of its second moments only I_zz = Sigma_xx + Sigma_yy
    # is felt
    first = np.zeros((4, 4))
    first[0, 0] = bodies[0][0, 0] + bodies[0][1, 1]
    first[:2, 3] = first[3, :2] = bodies[0][:2, 3]
    bodies[0] = first
    return bodies
