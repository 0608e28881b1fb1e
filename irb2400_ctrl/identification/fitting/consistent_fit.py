"""Least squares over bodies that can exist: a convex programme with linear matrix inequalities.

    minimise  1/2 theta^T A theta - b^T theta
    so that   P_i(theta) = [[ tr(I_O)/2 1 - I_O, h ], [ h^T, m ]] > 0  for every link,
              theta_k > 0                                              for friction and rotors

P_i, the pseudo-inertia in kg and m, is positive definite exactly for bodies that can exist
(Wensing, Kim, Slotine 2018; as a programme: Sousa, Cortesao 2014). The minimum is unique; it is
followed from the inside with a barrier, mu (log det P_i + log theta_k), mu falling, so that every
result is strictly possible.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers

START_BARRIER = 1e3
NEAR_BARRIER = 1.0
END_BARRIER = 1e-2
"""[nats] the last mu: each of its 4 n + k bounds may cost that much, which is no evidence"""
NEWTON_STEPS = 60
ELEMENTS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""of an inertia, in the order of phi"""


def _unit_pseudo_inertias() -> Array:
    """P of each unit vector of phi = (m, m c, Ixx, Ixy, Ixz, Iyy, Iyz, Izz), shape (10, 4, 4)."""
    E = np.zeros((10, 4, 4))
    E[0, 3, 3] = 1.0
    for k in range(3):
        E[1 + k, k, 3] = E[1 + k, 3, k] = 1.0
    for k, (i, j) in enumerate(ELEMENTS):
        if i == j:
            E[4 + k, :3, :3] = 0.5 * np.eye(3)
            E[4 + k, i, i] -= 1.0
        else:
            E[4 + k, i, j] = E[4 + k, j, i] = -1.0
    return E


UNIT = _unit_pseudo_inertias()


def pseudo_inertias(phi: Array) -> Array:
    """P of bodies phi (k, 10), shape (k, 4, 4)."""
    return np.tensordot(phi, UNIT, 1)


def possible(phi: Array, least: float = 1e-3) -> Array:
    """Bodies (k, 10) moved strictly inside what is possible.

    Args:
        least: smallest eigenvalue of P that is left, over its trace.
    """
    found = np.array(phi)
    for row in range(len(phi)):
        P = pseudo_inertias(phi[row : row + 1])[0]
        values, vectors = np.linalg.eigh(P)
        floor = least * max(np.abs(values).sum(), 1e-3)
        if values.min() >= floor:
            continue
        P = (vectors * np.maximum(values, floor)) @ vectors.T
        Sigma = P[:3, :3]
        inertia = np.trace(Sigma) * np.eye(3) - Sigma
        found[row] = [P[3, 3], *P[:3, 3], *inertia[np.triu_indices(3)]]
    return found


@dataclass(frozen=True)
class _Programme:
    A: Array
    b: Array
    links: int
    positive: Integers

    def inside(self, theta: Array) -> bool:
        """Whether every bound holds strictly."""
        if (theta[self.positive] <= 0).any():
            return False
        P = pseudo_inertias(theta[: 10 * self.links].reshape(-1, 10))
        try:
            np.linalg.cholesky(P)
        except np.linalg.LinAlgError:
            return False
        return True

    def value(self, theta: Array, mu: float) -> float:
        """Objective with its barrier."""
        P = pseudo_inertias(theta[: 10 * self.links].reshape(-1, 10))
        barrier = np.linalg.slogdet(P)[1].sum() + np.log(theta[self.positive]).sum()
        return float(0.5 * theta @ self.A @ theta - self.b @ theta - mu * barrier)

    def slopes(self, theta: Array, mu: float) -> tuple[Array, Array]:
        """Gradient and second derivative of `value`."""
        gradient = self.A @ theta - self.b
        curvature = self.A.copy()
        P = pseudo_inertias(theta[: 10 * self.links].reshape(-1, 10))
        for link, inverse in enumerate(np.linalg.inv(P)):
            place = slice(10 * link, 10 * link + 10)
            turned = inverse @ UNIT
            gradient[place] -= mu * np.trace(turned, axis1=1, axis2=2)
            curvature[place, place] += mu * np.einsum("aij,bji->ab", turned, turned)
        gradient[self.positive] -= mu / theta[self.positive]
        curvature[self.positive, self.positive] += mu / theta[self.positive] ** 2
        return gradient, curvature


def consistent_minimum(
    A: Array, b: Array, links: int, positive: Integers, start: Array, *, near: bool = False
) -> Array:
    """theta of the programme above.

    Args:
        A: (p, p), positive definite; b: (p,).
        links: the first 10 * links numbers are bodies; positive: numbers that are above zero.
        start: strictly possible; near: the minimum of a programme much like this one.
    """
    programme = _Programme(A, b, links, positive)
    theta = start
    mu = NEAR_BARRIER if near else START_BARRIER
    while True:
        theta = _newton(programme, theta, mu)
        if mu <= END_BARRIER:
            return theta
        mu = max(mu / 10.0, END_BARRIER)


def _newton(programme: _Programme, theta: Array, mu: float) -> Array:
    for _ in range(NEWTON_STEPS):
        gradient, curvature = programme.slopes(theta, mu)
        size = 1.0 / np.sqrt(np.diag(curvature))
        step = -size * np.linalg.solve(curvature * size[:, None] * size, size * gradient)
        fall = float(-gradient @ step)
        if fall < 1e-3 * mu:
            break
        length = 1.0
        before = programme.value(theta, mu)
        while not programme.inside(theta + length * step) or (
            programme.value(theta + length * step, mu) > before - 0.1 * length * fall
        ):
            length *= 0.5
            if length < 1e-10:
                return theta
        theta = theta + length * step
    return theta
