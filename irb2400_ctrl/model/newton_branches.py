"""Numerical inverse kinematics of any six-axis arm: every root, made exact by Newton's method.

`CharacteristicRoots` leads close to all branches of a general arm, of which there are up to 16, but
not of one whose axes meet or are parallel. So rounds of slightly displaced arms follow, each drawn
anew, and their roots start Newton's method on the arm itself. The partner of a branch that is
nearly singular is looked for along the direction in which the arm hardly moves the tool. The rounds
end when some found nothing new and the signs balance: the map from joint angles to poses has degree
zero, as poses out of reach have no branch at all, so that the signs of det J over all branches of a
pose add up to zero. A further branch is then unlikely; it cannot be excluded. Each branch is exact
to rounding; none is false.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.codegen.build import CompiledFunction, compile_function
from irb2400_ctrl.model import kinematics
from irb2400_ctrl.model.characteristic_roots import CharacteristicRoots
from irb2400_ctrl.model.inverse_kinematics import Branches
from irb2400_ctrl.model.joint_box import JointBox, require_pose
from irb2400_ctrl.model.linear_solve import solve_ldl
from irb2400_ctrl.robot import Robot

DISPLACED = (1e-4, 1e-3)
"""of directions of axes, and of points over the arm's size, in turn: close roots ask for little,
rounding for much [-]"""
ROUNDS = 24
"""of displaced arms at most"""
QUIET = 4
"""rounds without a new branch that end the search"""
STEPS = 60
LOOK = 10
"""after so many steps a start that came no nearer than half as far is given up"""
DAMPING = 1e-6
"""of the first step: roots are near"""
CLOSE = 0.03
"""smallest singular value of J, with positions over the arm's size, that asks for a partner [-]"""
ACROSS = (-0.3, -0.1, -0.03, -0.01, 0.01, 0.03, 0.1, 0.3)
"""how far along the lost direction it is looked for [rad]"""
LARGEST_STEP = 0.7
"""of a joint in one step [rad]"""
EXACT = 1e-10
"""what counts as reached, of position over the arm's size and of rotation [-]"""
SAME = 1e-5
"""configurations closer than this are one [rad]"""
AT_ONCE = 64
"""poses"""


class NewtonBranches:
    """All branches that are found, of one robot.

    Args:
        quiet: rounds without a new branch that end the search; rounds: at most so many.
    """

    def __init__(self, robot: Robot, *, quiet: int = QUIET, rounds: int = ROUNDS) -> None:
        self.robot: Robot = robot
        self.quiet: int = quiet
        self.rounds: int = rounds
        self.n: int = robot.n
        self.box: JointBox = JointBox.of(robot)
        self.X_TF: Array = np.asarray(np.linalg.inv(robot.X_FT), dtype=float)
        lengths = [np.linalg.norm(link.frame.matrix()[:3, 3]) for link in robot.links]
        self.size: float = float(np.sum(lengths)) + 1e-3
        self._roots: list[CharacteristicRoots] = []

    @cached_property
    def _step(self) -> CompiledFunction:
        return compile_function(newton_step(self.robot, self.size), lanes=True)

    @cached_property
    def _jacobian(self) -> CompiledFunction:
        q = ca.SX.sym("q", self.n)
        at = kinematics.flange_pose(self.robot, q)[:3, 3]
        J = kinematics.point_jacobian(self.robot, q, at, self.n)
        return compile_function(ca.Function("flange_jacobian", [q], [ca.densify(J)]))

    def _of_round(self, number: int) -> CharacteristicRoots:
        """The arm itself, then displaced ones."""
        while len(self._roots) <= number:
            k = len(self._roots)
            displaced = DISPLACED[k % len(DISPLACED)] if k else 0.0
            self._roots.append(CharacteristicRoots(self.robot, self.size, displaced, seed=k))
        return self._roots[number]

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
        if seeds is not None:
            self._add(found, seeds, np.arange(len(X_BF)), X_BF)
        for number in range(self.rounds):
            going = np.flatnonzero([not pose.complete(self.quiet) for pose in found])
            if not len(going):
                break
            try:
                start, owner = self._of_round(number).starts(X_BF[going])
            except np.linalg.LinAlgError:
                continue
            for k in going:
                found[k].quiet += 1
            self._add(found, start, going[owner], X_BF)
        return [pose.sorted() for pose in found]

    def _add(self, found: list[_Found], start: Array, owner: Integers, X_BF: Array) -> None:
        """What Newton's method makes of starts (k, n) for poses `owner` (k,), and what it finds
        from there across singularities that are near."""
        while len(owner):
            q = self.descend(start, X_BF[owner], DAMPING)
            arrived = np.isfinite(q[:, 0])
            new = [found[k].add(one) for k, one in zip(owner[arrived], q[arrived], strict=True)]
            q = q[arrived][new]
            owner = owner[arrived][new]
            if not len(q):
                return
            J = self._jacobian.map(q)[0]
            J[:, :3] /= self.size
            for k, sign in zip(owner, np.sign(np.linalg.det(J)), strict=True):
                found[k].sign += float(sign)
            _, value, direction = np.linalg.svd(J)
            close = value[:, -1] < CLOSE
            start = q[close, None] + np.outer(ACROSS, np.ones(self.n)) * direction[close, -1:]
            start = start.reshape(-1, self.n)
            owner = np.repeat(owner[close], len(ACROSS))

    def descend(self, q: Array, X_BF: Array, damping: float) -> Array:
        """Damped Newton from starts (m, n) to poses (m, 4, 4); nan where it does not arrive.

        Args:
            q: starts [rad], shape (m, n).
            X_BF: poses of the flange in the base [m], shape (m, 4, 4).
            damping: of the first step; less while the error falls, more where it grows.
        """
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
    """The branches of one pose so far, the sign of their det J, and since how many rounds there was
    none new."""

    def __init__(self, n: int) -> None:
        self.q: Array = np.empty((0, n))
        self.sign: float = 0.0
        self.quiet: int = 0

    def complete(self, quiet: int) -> bool:
        """Long nothing new, and no partner left: they come and go in pairs of unlike sign."""
        return self.sign == 0 and self.quiet >= quiet

    def add(self, q: Array) -> bool:
        """Whether a configuration (n,) that reaches the pose is new; it is kept then."""
        if (np.abs(np.exp(1j * self.q) - np.exp(1j * q)).max(axis=1) < SAME).any():
            return False
        self.q = np.vstack([self.q, np.angle(np.exp(1j * q))])
        self.quiet = 0
        return True

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
