"""Inverse kinematics of an arm that is near a family with a closed form: a calibrated arm.

The closed form of the family leads close to each of the eight branches; Newton's method on the
arm's own chain makes them exact. Branches keep their numbers, so what follows a branch along a path
may follow these. Two that meet in a singularity are one; a branch that Newton does not reach there
does not exist.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.inverse_kinematics import Branches
from irb2400_ctrl.model.joint_box import require_pose
from irb2400_ctrl.model.newton_branches import EXACT, SAME, NewtonBranches

STEPS = 25
BEYOND = 0.02
"""overreach of the closed form over the arm's size up to which a branch may still exist [-]"""
LARGEST_STEP = 0.3
"""of a joint in one step [rad]"""


class Seeds(Protocol):
    """Configurations to start from: those of the closed form."""

    def nearest(self, X_BF: Array, seed: Array | None) -> Branches:
        """Eight for each pose, those of the nearest reach where one is beyond it."""


class PolishedBranches:
    """The branches of one robot."""

    def __init__(self, seeds: Seeds, newton: NewtonBranches) -> None:
        self.seeds: Seeds = seeds
        self.newton: NewtonBranches = newton

    def many(self, X_BF: Array, seed: Array | None) -> Branches:
        """Poses (m, 4, 4)."""
        start = self.seeds.nearest(X_BF, seed)
        m, branches, n = start.q.shape
        poses = np.broadcast_to(X_BF[:, None], (m, branches, 4, 4)).reshape(-1, 4, 4)
        tried = np.flatnonzero(start.overreach.ravel() < BEYOND * self.newton.size)
        q = np.full((m * branches, n), np.nan)
        q[tried] = self._polished(start.q.reshape(-1, n)[tried], poses[tried])
        q = np.pi - np.mod(np.pi - q, 2 * np.pi)
        q = _once(q.reshape(m, branches, n), start.q)
        exists = np.isfinite(q).all(axis=2)
        least = EXACT * self.newton.size
        return Branches(q, np.where(exists, 0.0, np.maximum(start.overreach, least)))

    def one(self, X_BF: Array, seed: Array | None) -> tuple[Array, Array]:
        """One pose (4, 4)."""
        found = self.many(X_BF[None], seed)
        return found.q[0], found.overreach[0]

    def inside(self, X_BF: Array, seed: Array | None) -> Array:
        """One pose, every configuration with the whole turns that the joint box allows.

        Where a branch got lost (near a singularity they meet, and others come), all are searched
        from many starts.
        """
        require_pose(X_BF)
        q = self.one(X_BF, seed)[0]
        near = self.seeds.nearest(X_BF[None], seed).overreach[0] < BEYOND * self.newton.size
        if not np.isfinite(q[near]).all():
            searched = self.newton.one(X_BF, seed)[0]
            q = _once(np.vstack([q, searched])[None], np.vstack([q, searched])[None])[0]
        return self.newton.box.windings(q)

    def _polished(self, q: Array, X_BF: Array) -> Array:
        """Damped Newton from a start for each pose; nan where it does not arrive, shape (k, n)."""
        q = q.copy()
        n = q.shape[1]
        going = np.arange(len(q))
        arrived = np.zeros(len(q), dtype=bool)
        for _ in range(STEPS):
            error, J = self.newton.error(q[going], X_BF[going])
            size = np.sum(error**2, axis=1)
            arrived[going[size < EXACT**2]] = True
            on = ~(size < EXACT**2)
            going = going[on]
            if not len(going):
                break
            J = J[on]
            JT = J.transpose(0, 2, 1)
            # far less than any singular value away from a singularity, and none near the solution
            normal = JT @ J + np.minimum(size[on], 1e-4)[:, None, None] * np.eye(n)
            step = np.linalg.solve(normal + 1e-16 * np.eye(n), JT @ error[on][..., None])[..., 0]
            largest = np.abs(step).max(axis=1, keepdims=True)
            q[going] += step * np.minimum(1.0, LARGEST_STEP / np.maximum(largest, 1e-12))
        q[~arrived] = np.nan
        return q


def _once(q: Array, start: Array) -> Array:
    """Without branches that are another one's again: the one that started nearer stays."""
    found = q.copy()
    moved = np.abs(np.exp(1j * q) - np.exp(1j * start)).max(axis=2)
    for a in range(q.shape[1]):
        for b in range(a + 1, q.shape[1]):
            same = np.abs(np.exp(1j * q[:, a]) - np.exp(1j * q[:, b])).max(axis=1) < SAME
            nearer = moved[:, a] <= moved[:, b]
            found[same & nearer, b] = np.nan
            found[same & ~nearer, a] = np.nan
    return found
