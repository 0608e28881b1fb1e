"""Numerical inverse kinematics of any six-axis arm: Newton's method from many starts.

A general arm has up to 16 branches and no closed form. Of many drawn configurations those whose
pose is nearest are the starts: each branch then has a share of them that grows as the arm's
Jacobian shrinks, as its neighbourhood where Newton's method arrives shrinks too. Rounds of starts
end when every branch was found several times over and their signs balance: the map from joint
angles to poses has degree zero, as poses out of reach have no branch at all, so that the signs of
det J over all branches of a pose add up to zero. From a branch close to a singularity starts go
across it as well, where its partner is. A further branch is then unlikely to be left; it cannot be
excluded. Each branch is exact to rounding; none is false.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen.build import CompiledFunction, compile_function
from irb2400_ctrl.model import kinematics
from irb2400_ctrl.model.inverse_kinematics import Branches
from irb2400_ctrl.model.joint_box import JointBox, require_pose
from irb2400_ctrl.model.linear_solve import solve_ldl
from irb2400_ctrl.robot import Robot

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

DRAWN = 20_000
"""configurations, once for an arm"""
STARTS = 96
"""of one round"""
ROUNDS = 12
SEEN = 8
STEPS = 60
LOOK = 10
"""after so many steps a start that came no nearer than half as far is given up"""
LARGEST_STEP = 0.7
"""of a joint in one step [rad]"""
EXACT = 1e-10
"""what counts as reached, of position over the arm's size and of rotation [-]"""
SAME = 1e-5
"""configurations closer than this are one [rad]"""
AT_ONCE = 64
"""poses"""
CLOSE = 0.03
"""smallest singular value of the Jacobian from which on a partner across is looked for [-]"""
ACROSS = (-0.6, -0.3, -0.1, 0.1, 0.3, 0.6)
"""along the direction that the singularity loses [rad]"""


class NewtonBranches:
    """All branches that the search finds, of one robot.

    Args:
        seen: how often every branch must have been found before the search ends; rounds: at most so
            many rounds of starts.
    """

    def __init__(self, robot: Robot, *, seen: int = SEEN, rounds: int = ROUNDS) -> None:
        self.robot: Robot = robot
        self.seen: int = seen
        self.rounds: int = rounds
        self.n: int = robot.n
        self.box: JointBox = JointBox.of(robot)
        self.X_TF: Array = np.asarray(np.linalg.inv(robot.X_FT), dtype=float)
        lengths = [np.linalg.norm(link.frame.matrix()[:3, 3]) for link in robot.links]
        self.size: float = float(np.sum(lengths)) + 1e-3

    @cached_property
    def _step(self) -> CompiledFunction:
        return compile_function(newton_step(self.robot, self.size), lanes=True)

    @cached_property
    def _jacobian(self) -> CompiledFunction:
        q = ca.SX.sym("q", self.n)
        at = kinematics.flange_pose(self.robot, q)[:3, 3]
        J = kinematics.point_jacobian(self.robot, q, at, self.n)
        return compile_function(ca.Function("flange_jacobian", [q], [ca.densify(J)]))

    @cached_property
    def _drawn(self) -> Array:
        return np.random.default_rng(0).uniform(-np.pi, np.pi, (DRAWN, self.n))

    @cached_property
    def _near(self) -> cKDTree:
        # here: arms with a closed form start without it
        from scipy.spatial import cKDTree

        pose = ca.Function("pose", [q := ca.SX.sym("q", self.n)], [
            ca.densify(kinematics.flange_pose(self.robot, q))
        ])  # fmt: skip
        return cKDTree(self._place(compile_function(pose).map(self._drawn)[0]))

    def _place(self, X_BF: Array) -> Array:
        """Poses (m, 4, 4) as points, apart as `newton_step` has its error, shape (m, 12)."""
        turned = X_BF[:, :3, :3].reshape(-1, 9) / np.sqrt(2)
        return np.concatenate([X_BF[:, :3, 3] / self.size, turned], axis=1)

    def many(self, X_BF: Array, seed: Array | None) -> Branches:
        """Poses (n, 4, 4)."""
        seeds = None if seed is None else np.broadcast_to(seed, (len(X_BF), self.n))
        found: list[Array] = []
        for first in range(0, len(X_BF), AT_ONCE):
            part = slice(first, first + AT_ONCE)
            found += self._searched(X_BF[part], None if seeds is None else seeds[part])
        most = max((len(q) for q in found), default=0)
        angles = np.full((len(X_BF), most, self.n), np.nan)
        for row, q in zip(angles, found, strict=True):
            row[: len(q)] = q
        return Branches(angles, np.where(np.isfinite(angles).all(axis=2), 0.0, np.inf))

    def one(self, X_BF: Array, seed: Array | None) -> tuple[Array, Array]:
        """One pose; the same pose finds the same branches in the same order."""
        q = self.many(X_BF[None], seed).q[0]
        if len(q):
            return q, np.zeros(len(q))
        short = max(float(np.linalg.norm(X_BF[:3, 3])) - self.size, 0.0)
        return np.full((1, self.n), np.nan), np.array([short])

    def inside(self, X_BT: Array, seed: Array | None) -> Array:
        """One pose of the tool, every configuration found with the whole turns that the joint box
        allows."""
        require_pose(X_BT)
        return self.box.windings(self.one(X_BT @ self.X_TF, seed)[0])

    def _searched(self, X_BF: Array, seeds: Array | None) -> list[Array]:
        """Branches (b, n) of each pose, in one order of their angles."""
        found = [_Found(self.n) for _ in X_BF]
        for number in range(self.rounds):
            going = np.flatnonzero([not pose.complete(self.seen) for pose in found])
            if not len(going):
                break
            nearest = range(1 + number * STARTS, 1 + (number + 1) * STARTS)
            start = self._drawn[self._near.query(self._place(X_BF[going]), nearest)[1]]
            if number == 0 and seeds is not None:
                start[:, 0] = seeds
            poses = np.repeat(X_BF[going], STARTS, axis=0)
            arrived = self.descend(start.reshape(-1, self.n), poses).reshape(start.shape)
            for k, q in zip(going, arrived, strict=True):
                found[k].add(q[np.isfinite(q[:, 0])])
            self._complete_pairs([found[k] for k in going], X_BF[going])
        return [pose.sorted() for pose in found]

    def _complete_pairs(self, found: list[_Found], X_BF: Array) -> None:
        """Give new branches the sign of det J, and look for their partners across singularities."""
        while True:
            news = [pose.q[len(pose.sign) :] for pose in found]
            new = np.concatenate(news)
            if not len(new):
                return
            J = self._jacobian.map(new)[0]
            J[:, :3] /= self.size
            signs = np.split(np.sign(np.linalg.det(J)), np.cumsum([len(q) for q in news])[:-1])
            for pose, sign in zip(found, signs, strict=True):
                pose.sign = np.append(pose.sign, sign)
            _, value, direction = np.linalg.svd(J)
            close = np.flatnonzero(value[:, -1] < CLOSE)
            if not len(close):
                return
            owner = np.repeat(np.arange(len(found)), [len(q) for q in news])[close]
            start = new[close][:, None] + np.outer(ACROSS, np.ones(self.n)) * direction[close, -1:]
            poses = np.repeat(X_BF[owner], len(ACROSS), axis=0)
            arrived = self.descend(start.reshape(-1, self.n), poses).reshape(start.shape)
            for k, q in zip(owner, arrived, strict=True):
                found[k].add(q[np.isfinite(q[:, 0])], by_chance=False)

    def descend(self, q: Array, X_BF: Array, damping: float = 1e-2) -> Array:
        """Damped Newton from starts (m, n) to poses (m, 4, 4); nan where it does not arrive."""
        state = np.column_stack([q, np.full(len(q), damping)])
        flat = np.ascontiguousarray(X_BF, dtype=float)
        going = np.arange(len(q))
        before = np.full(len(q), np.inf)
        arrived = np.zeros(len(q), dtype=bool)
        for number in range(1, STEPS + 1):
            state[going], size = self._step.map(state[going], flat[going])
            there = size[:, 0] < EXACT**2
            arrived[going[there]] = True
            on = ~there & np.isfinite(size[:, 0])
            if number % LOOK == 0:
                on &= size[:, 0] < 0.25 * before[going]
                before[going] = size[:, 0]
            going = going[on]
            if not len(going):
                break
        last, _ = self._step.map(state[arrived], flat[arrived]) if arrived.any() else (state, None)
        found = np.full_like(q, np.nan)
        found[arrived] = last[: int(arrived.sum()), : self.n]
        return found


class _Found:
    """The branches of one pose so far, how often each was found, and the sign of its det J."""

    def __init__(self, n: int) -> None:
        self.q: Array = np.empty((0, n))
        self.seen: Array = np.empty(0, dtype=int)
        self.sign: Array = np.empty(0)

    def complete(self, seen: int) -> bool:
        """Every branch often enough, and no partner left: they come and go in pairs of unlike
        sign."""
        return len(self.q) > 0 and self.sign.sum() == 0 and bool(self.seen.min() >= seen)

    def add(self, q: Array, *, by_chance: bool = True) -> None:
        """Configurations (k, n) that reach the pose; those looked for on purpose do not count as
        seen."""
        rest = np.exp(1j * q)
        for k, known in enumerate(np.exp(1j * self.q)):
            same = np.abs(rest - known).max(axis=1) < SAME
            self.seen[k] += int(same.sum()) * by_chance
            rest = rest[~same]
        while len(rest):
            same = np.abs(rest - rest[0]).max(axis=1) < SAME
            self.q = np.vstack([self.q, np.angle(rest[0])])
            self.seen = np.append(self.seen, int(same.sum()) * by_chance)
            rest = rest[~same]

    def sorted(self) -> Array:
        return np.asarray(self.q[np.lexsort(np.round(self.q.T, 6))])


def newton_step(robot: Robot, size: float) -> ca.Function:
    """((q, damping) (n + 1,), X_BF (4, 4)) -> (the same after a step, squared error there).

    A step of Levenberg and Marquardt: one that leads farther away is not taken, but damped more.
    The error is position over `size` and rotation vector, through half a turn without a fold.
    """
    n = robot.n
    state = ca.SX.sym("state", n + 1)
    X_BF = ca.SX.sym("X_BF", 4, 4)
    q = state[:n]
    X = kinematics.flange_pose(robot, q)
    J = kinematics.point_jacobian(robot, q, X[:3, 3], n)
    J = ca.vertcat(J[:3, :] / size, J[3:, :])
    error = _to_go(X, X_BF, size)
    step = solve_ldl(J.T @ J + state[n] * ca.SX.eye(n), J.T @ error)
    scale = ca.fmin(1.0, LARGEST_STEP / ca.fmax(ca.norm_inf(step), 1e-12))
    tried = q + scale * step
    before = ca.sumsqr(error)
    after = ca.sumsqr(_to_go(kinematics.flange_pose(robot, tried), X_BF, size))
    better = after < before
    damping = ca.fmin(ca.fmax(state[n] * ca.if_else(better, 0.125, 4.0), 1e-16), 1e3)
    outputs = ca.cse([
        ca.vertcat(ca.if_else(better, tried, q), damping), ca.if_else(better, after, before)
    ])  # fmt: skip
    return ca.Function("newton_step", [state, X_BF], outputs)


def _to_go(X: ca.SX, X_BF: ca.SX, size: float) -> ca.SX:
    R = X_BF[:3, :3] @ X[:3, :3].T
    sine = ca.vertcat(R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1])
    length = ca.norm_2(sine) / 2
    angle = ca.atan2(length, (ca.trace(R) - 1) / 2)
    scale = ca.if_else(length > 1e-12, angle / ca.fmax(2 * length, 1e-300), 0.5)
    return ca.vertcat((X_BF[:3, 3] - X[:3, 3]) / size, scale * sine)
