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

BEYOND = 0.02
"""overreach of the closed form over the arm's size up to which a branch may still exist [-]"""
NEAR = 1e-8
"""damping of the first step: the start is near"""


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
        q[tried] = self.newton.descend(start.q.reshape(-1, n)[tried], poses[tried], NEAR)
        q = np.pi - np.mod(np.pi - q, 2 * np.pi)
        q = _once(q.reshape(m, branches, n), start.q)
        exists = np.isfinite(q).all(axis=2)
        least = EXACT * self.newton.size
        return Branches(q, np.where(exists, 0.0, np.maximum(start.overreach, least)))

    def one(self, X_BF: Array, seed: Array | None) -> tuple[Array, Array]:
        """One pose (4, 4)."""
        found = self.many(X_BF[None], seed)
        return found.q[0], found.overreach[0]

    def inside(self, X_BT: Array, seed: Array | None) -> Array:
        """One pose of the tool, every configuration with the whole turns that the box allows.

        Where a branch got lost (near a singularity they meet, and others come), all are looked for
        as on an arm of no family.
        """
        require_pose(X_BT)
        X_BF = X_BT @ self.newton.X_TF
        q = self.one(X_BF, seed)[0]
        near = self.seeds.nearest(X_BF[None], seed).overreach[0] < BEYOND * self.newton.size
        if not np.isfinite(q[near]).all():
            searched = self.newton.one(X_BF, seed)[0]
            q = _once(np.vstack([q, searched])[None], np.vstack([q, searched])[None])[0]
        return self.newton.box.windings(q)


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
