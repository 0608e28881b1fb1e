"""Could any bodies at all make a robot's torques?

The torque knows the base parameters only. Many sets of link parameters share them, and a table with
impossible bodies may still be one whose torques possible bodies could make (Sousa, Cortesao 2014).
The question is a small semidefinite programme over the parameters that the torque does not see,

    smallest s with J_i(z) + s 1 >= 0 for every link,    J_i the pseudo-inertias in kg and m,

solved here by a barrier and Newton's method: s < 0 means that such bodies exist, and the best z
gives them.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.base_parameters import base_parameters
from irb2400_ctrl.model.bodies import pseudo_inertia
from irb2400_ctrl.robot import Robot

GAP = 1e-6
"""how near to the best s the search stops"""
STAY = 1e-6
"""weight that keeps parameters nobody sees near the table's"""


@dataclass(frozen=True)
class Realisation:
    """The most realisable link parameters with the robot's torques."""

    margin: float
    """smallest eigenvalue over the pseudo-inertias of all links; above zero: such bodies exist"""
    phi: Array
    """link parameters that reach it, same torque in every motion, shape (n, 10)"""

    @property
    def exists(self) -> bool:
        """Real bodies could make these torques."""
        return self.margin > 0.0


def realise(robot: Robot) -> Realisation:
    """Link parameters with the torques of `robot` (tool in the last link) that come nearest to real
    bodies, or are."""
    n = robot.n
    phi = robot.inertial_parameters.ravel()
    unseen = base_parameters(robot, robot.inertial_parameters).unseen
    start = _pseudo_inertias(phi, n)
    directions = np.array([_pseudo_inertias(row, n) for row in unseen])
    z = _best(start, directions)
    best = (phi + unseen.T @ z).reshape(n, 10)
    best.setflags(write=False)
    return Realisation(float(np.linalg.eigvalsh(_pseudo_inertias(best.ravel(), n)).min()), best)


def _pseudo_inertias(phi: Array, n: int) -> Array:
    return np.array([np.array(ca.evalf(pseudo_inertia(ca.DM(row)))) for row in phi.reshape(n, 10)])


def _best(start: Array, directions: Array) -> Array:
    """z of the smallest s: the path of minima of t s - sum log det(J(z) + s 1) for growing t."""
    count = len(directions)
    shifts = np.concatenate([directions, np.broadcast_to(np.eye(4), (1, *start.shape))])
    x = np.zeros(count + 1)
    x[-1] = 1.0 - np.linalg.eigvalsh(start).min()
    stay = STAY * np.append(np.ones(count), 0.0)
    t = 1.0
    while 4 * len(start) / t > GAP:
        for _ in range(100):
            inverse = np.linalg.inv(start + np.tensordot(x, shifts, 1))
            weighed = np.einsum("iab,kibc->kiac", inverse, shifts)
            gradient = t * stay * x - np.einsum("kiaa->k", weighed)
            gradient[-1] += t
            hessian = np.einsum("kiab,liba->kl", weighed, weighed) + t * np.diag(stay)
            step = -np.linalg.solve(hessian, gradient)
            decrement = float(-gradient @ step)
            # damped Newton on a self-concordant function never leaves the cone
            x = x + step / (1.0 + np.sqrt(max(decrement, 0.0)))
            if decrement < 1e-9:
                break
        t *= 10.0
    return x[:-1]
