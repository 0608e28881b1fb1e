"""Numerical inverse kinematics of any six-axis arm: Newton's method from many starts.

A general arm has up to 16 branches and no closed form. Starts are drawn in rounds until every
branch was found several times over, so that a further one is unlikely to be left; it cannot be
excluded. Each branch is exact to rounding; none is false.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import kinematics
from irb2400_ctrl.model.inverse_kinematics import Branches
from irb2400_ctrl.model.joint_box import JointBox, require_pose
from irb2400_ctrl.robot import Robot

STARTS = 96
"""of one round"""
ROUNDS = 12
SEEN = 4
"""every branch must have been found so often before the search ends"""
STEPS = 60
LARGEST_STEP = 0.7
"""of a joint in one step [rad]"""
EXACT = 1e-10
"""what counts as reached, of position over the arm's size and of rotation [-]"""
SAME = 1e-5
"""configurations closer than this are one [rad]"""


class NewtonBranches:
    """All branches that the search finds, of one robot."""

    def __init__(self, robot: Robot) -> None:
        q = ca.SX.sym("q", robot.n)
        X = kinematics.flange_pose(robot, q)
        J = kinematics.point_jacobian(robot, q, X[:3, 3], robot.n)
        self.n: int = robot.n
        self.box: JointBox = JointBox.of(robot)
        outputs = ca.cse([ca.densify(X), ca.densify(J)])
        self.function: ca.Function = ca.Function("pose", [q], outputs)
        lengths = [np.linalg.norm(link.frame.matrix()[:3, 3]) for link in robot.links]
        self.size: float = float(np.sum(lengths)) + 1e-3

    def many(self, X_BF: Array, seed: Array | None) -> Branches:
        """Poses (n, 4, 4), one after the other."""
        seeds = [None] * len(X_BF) if seed is None else np.broadcast_to(seed, (len(X_BF), self.n))
        found = [self.one(X, s)[0] for X, s in zip(X_BF, seeds, strict=True)]
        most = max((len(q) for q in found), default=0)
        angles = np.full((len(X_BF), most, self.n), np.nan)
        for row, q in zip(angles, found, strict=True):
            row[: len(q)] = q
        return Branches(angles, np.where(np.isfinite(angles).all(axis=2), 0.0, np.inf))

    def one(self, X_BF: Array, seed: Array | None) -> tuple[Array, Array]:
        """One pose; the same pose finds the same branches in the same order."""
        rng = np.random.default_rng(0)
        found = np.empty((0, self.n))
        seen = np.empty(0, dtype=int)
        for number in range(ROUNDS):
            start = rng.uniform(-np.pi, np.pi, (STARTS, self.n))
            if number == 0 and seed is not None:
                start[0] = seed
            for q in self._descend(start, X_BF):
                apart = np.abs(np.exp(1j * found) - np.exp(1j * q)).max(axis=1)
                near = np.flatnonzero(apart < SAME)
                if len(near):
                    seen[near[0]] += 1
                else:
                    found = np.vstack([found, q])
                    seen = np.append(seen, 1)
            if len(found) and seen.min() >= SEEN:
                break
        order = np.lexsort(np.round(found.T, 6))
        wrapped = np.pi - np.mod(np.pi - found[order], 2 * np.pi)
        if len(wrapped):
            return wrapped, np.zeros(len(wrapped))
        short = max(float(np.linalg.norm(X_BF[:3, 3])) - self.size, 0.0)
        return np.full((1, self.n), np.nan), np.array([short])

    def inside(self, X_BF: Array, seed: Array | None) -> Array:
        """One pose, every configuration found with the whole turns that the joint box allows."""
        require_pose(X_BF)
        return self.box.windings(self.one(X_BF, seed)[0])

    def _descend(self, q: Array, X_BF: Array) -> Array:
        """Damped Newton from every start at once; the configurations that arrived, shape (k, n)."""
        q = q.copy()
        damping = np.full(len(q), 1e-2)
        error, J = self.error(q, X_BF)
        for _ in range(STEPS):
            size = (error**2).sum(axis=1)
            if ((size < EXACT**2) | ~np.isfinite(size)).all():
                break
            JT = J.transpose(0, 2, 1)
            normal = JT @ J + damping[:, None, None] * np.eye(self.n)
            step = np.linalg.solve(normal, (JT @ error[..., None]))[..., 0]
            largest = np.abs(step).max(axis=1, keepdims=True)
            step *= np.minimum(1.0, LARGEST_STEP / np.maximum(largest, 1e-12))
            tried = q + step
            error_tried, J_tried = self.error(tried, X_BF)
            better = (error_tried**2).sum(axis=1) < size
            q[better] = tried[better]
            error[better] = error_tried[better]
            J[better] = J_tried[better]
            damping = np.clip(np.where(better, damping / 8, damping * 4), 1e-16, 1e3)
        return np.asarray(q[(error**2).sum(axis=1) < EXACT**2])

    def error(self, q: Array, X_BF: Array) -> tuple[Array, Array]:
        """(position over size, rotation) still to go, shape (m, 6), and its slope, (m, 6, n).

        Args:
            q: configurations (m, n); X_BF: one pose (4, 4) for all, or one for each (m, 4, 4).
        """
        m = len(q)
        flat_X, flat_J = self.function(ca.DM(np.ascontiguousarray(q.T)))
        X = np.asarray(flat_X).reshape(4, m, 4).transpose(1, 0, 2)
        J = np.asarray(flat_J).reshape(6, m, self.n).transpose(1, 0, 2).copy()
        J[:, :3] /= self.size
        go = (X_BF[..., :3, 3] - X[:, :3, 3]) / self.size
        R = X_BF[..., :3, :3] @ X[:, :3, :3].transpose(0, 2, 1)
        sine = np.stack(
            [R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1
        )
        # the rotation vector: angle along the axis, through half a turn without a fold
        cosine = np.clip((np.trace(R, axis1=1, axis2=2) - 1) / 2, -1.0, 1.0)
        length = np.linalg.norm(sine, axis=1) / 2
        angle = np.arctan2(length, cosine)
        scale = np.where(length > 1e-12, angle / np.maximum(2 * length, 1e-300), 0.5)
        return np.concatenate([go, sine * scale[:, None]], axis=1), J
