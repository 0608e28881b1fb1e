"""From branches to what the joint box allows: whole turns, and the controller's coupled bound.

One pose at a time costs as much as its arrays, so the closed form does all of this in machine code:
every combination of turns where the box allows few (`boxed`), how often each angle fits where it
allows many, or where an angle lies on both ends of a box of whole turns (`wound`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.inverse_kinematics import BRANCHES
from irb2400_ctrl.robot import Robot

ROTATION = 2e-6
"""by which the columns of a pose may miss unit length and right angles, root of all squares [-]"""
_TOLERANCE = 1e-9
_TURN = 2 * np.pi
_MOST_TURNS = 40
_MOST_IN_ALL = 1_000_000


def check_radians(robot: Robot, seed: Array) -> None:
    """Refuse angles [rad], shape (n,), that no arm gets to and that are this arm's as degrees.

    Raises:
        InputError: more than a whole turn outside the joint box, and inside it as degrees.
    """

    def outside(angles: Array) -> float:
        return float(np.maximum(angles - robot.q_max, robot.q_min - angles).max())

    if outside(seed) > _TURN and outside(np.radians(seed)) <= 0.0:
        worst = int(np.argmax(np.abs(seed)))
        raise InputError(
            f"seed: found {seed[worst]:g} rad on axis {worst + 1}, expected actuator angles in "
            "radians; the numbers fit if they are degrees: np.radians(seed)"
        )


@dataclass(frozen=True)
class JointBox:
    """Where the actuator angles may be [rad]."""

    low: Array
    high: Array
    difference: tuple[float, float] | None = None
    """of q3 - q2"""

    @classmethod
    def of(cls, robot: Robot) -> JointBox:
        """The robot's own."""
        bound = robot.coupling.difference_deg
        if bound is None:
            return cls(robot.q_min, robot.q_max)
        return cls(robot.q_min, robot.q_max, (math.radians(bound[0]), math.radians(bound[1])))

    def usual_turns(self) -> Array:
        """How many angles a whole turn apart the box holds at most, for each joint, shape (n,); one
        more where it is whole turns wide and an angle lies on its ends."""
        return np.ceil((self.high - self.low - 2 * _TOLERANCE) / _TURN).astype(int)

    def windings(self, q: Array) -> Array:
        """Every q + 2 pi k inside, shape (m, n), for branches q (b, n), nan where there is none."""
        lowest = q + _TURN * np.ceil((self.low - _TOLERANCE - q) / _TURN)
        count = np.floor((self.high + _TOLERANCE - lowest) / _TURN) + 1.0
        return self.allowed(unwound(lowest, np.where(np.isfinite(count), count, 0.0)))

    def allowed(self, q: Array) -> Array:
        """Of configurations (m, n) those within the coupled bound, shape (k, n)."""
        if self.difference is None:
            return q
        between = q[:, 2] - q[:, 1]
        low, high = self.difference
        return np.asarray(q[(between >= low - _TOLERANCE) & (between <= high + _TOLERANCE)])


def skewness(X: ca.SX) -> ca.SX:
    """By how much columns miss unit length and right angles, and the last row 0, 0, 0, 1; more than
    1 where they are left-handed, no number where an entry is none."""
    R = X[:3, :3]
    off = ca.norm_fro(R.T @ R - ca.DM.eye(3))
    off += ca.norm_1(X[3, :] - ca.DM([[0, 0, 0, 1]]))
    return off + 2 * (ca.dot(ca.cross(R[:, 0], R[:, 1]), R[:, 2]) <= 0)


def require_rotation(skew: float) -> None:
    """Refuse a pose of this skewness.

    Raises:
        InputError: its upper left block is no rotation.
    """
    if not skew <= ROTATION:
        raise InputError(
            "inverse kinematics: found a pose whose upper left (3, 3) block is not a rotation, or "
            "whose last row is not 0, 0, 0, 1; expected [[R, p], [0, 0, 0, 1]] (transposed?)"
        )


def require_pose(X: Array) -> None:
    """The same of a pose (4, 4)."""
    require_rotation(float(skewness(ca.SX(ca.DM(X)))))


def boxed(function: ca.Function, box: JointBox) -> ca.Function | None:
    """(X_BF, seed) -> (q (6, 8 k), fits (8 k,), checks (3,)): the branches with every whole turn
    that usually lies in the joint box, and which of them do; None where there are too many.

    The checks: skewness, how many fit, and whether a branch has more turns than usual.
    """
    usual = box.usual_turns()
    if np.prod(usual.astype(float)) > _MOST_TURNS:
        return None
    turns = _all_turns(tuple(usual.tolist()))
    X_BF = ca.SX.sym("X_BF", 4, 4)
    seed = ca.SX.sym("seed", 6)
    q, overreach = function(X_BF, seed)
    lowest = _lowest(q, box)
    columns = []
    fits = []
    more = ca.SX(0)
    for k in range(BRANCHES):
        for j in range(len(box.high)):
            further = lowest[j, k] + _TURN * int(usual[j]) <= box.high[j] + _TOLERANCE
            more = ca.logic_or(more, ca.logic_and(overreach[k] <= 0, further))
        for turn in turns:
            angles = lowest[:, k] + ca.DM(turn)
            columns.append(angles)
            fits.append(ca.logic_and(overreach[k] <= 0, _allowed(angles, box)))
    checks = ca.vertcat(skewness(X_BF), ca.sum1(ca.vertcat(*fits)), more)
    outputs = ca.cse([ca.horzcat(*columns), ca.vertcat(*fits), checks])
    return ca.Function("boxed_inverse_kinematics", [X_BF, seed], outputs,
                       ["X_BF", "seed"], ["q", "fits", "checks"])  # fmt: skip


def _allowed(angles: ca.SX, box: JointBox) -> ca.SX:
    """Whether angles from the lowest on lie in the box, and within the coupled bound."""
    inside = ca.SX(1)
    for j in range(len(box.high)):
        inside = ca.logic_and(inside, angles[j] <= box.high[j] + _TOLERANCE)
    if box.difference is None:
        return inside
    low, high = box.difference
    between = angles[2] - angles[1]
    inside = ca.logic_and(inside, between >= low - _TOLERANCE)
    return ca.logic_and(inside, between <= high + _TOLERANCE)


def wound(function: ca.Function, box: JointBox) -> ca.Function:
    """(X_BF, seed) -> (q (6, 8), count (6, 8), skewness): the lowest angle in the joint box and how
    many whole turns apart fit; no count is positive where the branch does not exist."""
    X_BF = ca.SX.sym("X_BF", 4, 4)
    seed = ca.SX.sym("seed", 6)
    q, overreach = function(X_BF, seed)
    lowest = _lowest(q, box)
    high = ca.repmat(ca.DM(box.high + _TOLERANCE), 1, BRANCHES)
    count = ca.floor((high - lowest) * (1 / _TURN)) + 1
    exists = ca.repmat(overreach.T <= 0, len(box.high), 1)
    outputs = ca.cse([lowest, ca.if_else(exists, count, 0), skewness(X_BF)])
    return ca.Function("wound_inverse_kinematics", [X_BF, seed], outputs,
                       ["X_BF", "seed"], ["q", "count", "skewness"])  # fmt: skip


def _lowest(q: ca.SX, box: JointBox) -> ca.SX:
    low = ca.repmat(ca.DM(box.low - _TOLERANCE), 1, BRANCHES)
    return q + _TURN * ca.ceil((low - q) * (1 / _TURN))


def unwound(lowest: Array, count: Array) -> Array:
    """Every angle from the lowest, `count` of them a whole turn apart, shape (m, n); both
    (b, n).

    Raises:
        InputError: they are more than a million.
    """
    exists = count.min(axis=1) >= 1.0
    lowest = lowest[exists]
    in_all = float(np.prod(count[exists], axis=1).sum())
    if in_all > _MOST_IN_ALL:
        raise InputError(
            f"inverse kinematics: found {in_all:.3g} configurations of one pose, whole turns "
            f"counted, expected at most {_MOST_IN_ALL:,}: are the joint ranges of the robot file "
            "degrees where radians were expected?"
        )
    keys = [tuple(row) for row in count[exists].tolist()]
    if len(set(keys)) == 1:
        return np.asarray((lowest[:, None] + _all_turns(keys[0])).reshape(-1, lowest.shape[1]))
    rows = [angles + _all_turns(key) for angles, key in zip(lowest, keys, strict=True)]
    return np.concatenate(rows) if rows else lowest


@cache
def _all_turns(most: tuple[float, ...]) -> Array:
    """Every combination of fewer whole turns than `most` [rad], shape (k, n)."""
    counts = tuple(int(number) for number in most)
    turns = _TURN * np.indices(counts).reshape(len(counts), -1).T
    turns.setflags(write=False)
    return np.asarray(turns)
