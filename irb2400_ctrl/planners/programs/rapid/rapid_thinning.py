"""Which rows of a dense plan become targets of straight moves, so that the moves stay close to all
the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, norms
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid.linear_moves import LinearMoves, shares
from irb2400_ctrl.planners.programs.rapid.rapid_data import angle_between

IN_AIR = 25.0
"""times the tolerances within which joints stay that move between linear moves: a bent way over the
part in steps of a few milliseconds is more than a controller prepares in time"""


def rows_to_keep(*changes: npt.NDArray[np.bool_] | Array) -> npt.NDArray[np.bool_]:
    """Rows that stay targets whatever the tolerance: ends, and the last one before what is stated
    of the way to a row changes (pauses, `SingArea`, moves of joints, feeds); each (n,)."""
    keep = np.zeros(len(changes[0]), dtype=bool)
    keep[[0, -1]] = True
    for of_rows in changes:
        keep[:-1] |= of_rows[1:] != of_rows[:-1]
    return keep


def thinned(
    model: Model,
    q: Array,
    poses: tuple[Array, Array],
    keep: npt.NDArray[np.bool_],
    as_joints: npt.NDArray[np.bool_],
    tolerance: float,
    angle_tolerance: float,
) -> npt.NDArray[np.int64]:
    """Rows such that the straight moves between them stay within the tolerances of all rows
    skipped.

    From each kept row the next one is sought, first as far away as the two before are from each
    other, by doubling the step and halving it again.

    Args:
        q: the plan, shape (n, 6) [rad].
        poses: of the TCP in the base, and in the eyes of the part, each (n, 4, 4).
        keep: rows that stay in any case, shape (n,), ends included.
        as_joints: whether the way to a row is straight in joint space, else it is so in space with
            the shortest turn, shape (n,); where it changes, a row is kept.
        tolerance, angle_tolerance: of the TCP and its orientation [m, rad]; `IN_AIR` times so much
            where the joints move although others are linear.
    """
    wider = 1.0 if as_joints.all() else IN_AIR
    in_joints = _JointMoves.of(model, q, poses[0])
    in_space = LinearMoves.of(poses[1])

    def close(first: int, last: int) -> bool:
        if as_joints[last]:
            return in_joints.close(first, last, wider * tolerance, wider * angle_tolerance)
        return in_space.close(first, last, tolerance, angle_tolerance)

    forced = np.flatnonzero(keep)
    rows = [0]
    usual = 2
    while rows[-1] < len(q) - 1:
        first = rows[-1]
        limit = int(forced[np.searchsorted(forced, first, side="right")])
        good = first + 1
        bad = limit + 1
        step = usual
        while good < limit:
            tried = min(first + step, limit)
            if not close(first, tried):
                bad = tried
                break
            good = tried
            step = 2 * step
        while bad - good > 1 and good < limit:
            middle = (good + bad) // 2
            if close(first, middle):
                good = middle
            else:
                bad = middle
        usual = max(good - first, 2)
        rows.append(good)
    return np.array(rows, dtype=np.int64)


@dataclass(frozen=True)
class _JointMoves:
    """Moves that are straight in joint space, at even speed."""

    model: Model
    q: Array
    """[rad], shape (n, 6)"""
    X_BT: Array
    """the TCP at each row, shape (n, 4, 4)"""
    way: Array
    """from the first row to each, shape (n,) [rad]"""

    @classmethod
    def of(cls, model: Model, q: Array, X_BT: Array) -> _JointMoves:
        return cls(model, q, X_BT, np.append(0.0, np.cumsum(norms(np.diff(q, axis=0)))))

    def close(self, first: int, last: int, tolerance: float, angle: float) -> bool:
        """Whether the rows between are so near to the move from one to another [m, rad]."""
        rows = slice(first, last + 1)
        share = shares(self.way[rows])
        q = self.q[rows]
        move = self.model.tcp_pose(q[0] + share[:, None] * (q[-1] - q[0]))
        X = self.X_BT[rows]
        away = norms(move[:, :3, 3] - X[:, :3, 3]).max()
        turn = angle_between(move[:, :3, :3], X[:, :3, :3]).max()
        return bool(away <= tolerance and turn <= angle)
