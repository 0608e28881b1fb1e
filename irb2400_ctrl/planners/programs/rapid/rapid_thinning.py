"""Which rows of a dense plan become targets of straight moves, so that the moves stay close to all
the others."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid.rapid_data import angle_between, turned

# turning 1 rad counts like this length on the way through a segment [m]
_ARM_OF_ROTATION = 0.1


def rows_to_keep(*changes: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Rows that stay targets whatever the tolerance: ends, and the last one before what is stated
    of the way to a row changes (pauses, `SingArea`, moves of the joints); each shape (n,)."""
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

    From each kept row the next one is sought by doubling the step and halving it again.

    Args:
        q: the plan, shape (n, 6) [rad].
        poses: of the TCP in the base, and in the eyes of the part, each (n, 4, 4).
        keep: rows that stay in any case, shape (n,), ends included.
        as_joints: whether the way to a row is straight in joint space, else it is so in space with
            the shortest turn, shape (n,); where it changes, a row is kept.
        tolerance, angle_tolerance: of the TCP and its orientation [m, rad].
    """

    def close(first: int, last: int) -> bool:
        X = poses[0] if as_joints[last] else poses[1]
        distance, angle = deviation(
            model, q[first : last + 1], X[first : last + 1], bool(as_joints[last])
        )
        return distance <= tolerance and angle <= angle_tolerance

    forced = np.flatnonzero(keep)
    rows = [0]
    while rows[-1] < len(q) - 1:
        first = rows[-1]
        limit = int(forced[np.searchsorted(forced, first, side="right")])
        good = first + 1
        step = 2
        while good < limit and close(first, min(first + step, limit)):
            good = min(first + step, limit)
            step = 2 * step
        bad = min(first + step, limit)
        while bad - good > 1:
            middle = (good + bad) // 2
            if close(first, middle):
                good = middle
            else:
                bad = middle
        rows.append(good)
    return np.array(rows, dtype=np.int64)


def deviation(model: Model, q: Array, X_BT: Array, in_joint_space: bool) -> tuple[float, float]:
    """How far the plan's rows are from one straight move from the first to the last: TCP [m],
    orientation [rad]."""
    p = X_BT[:, :3, 3]
    R = X_BT[:, :3, :3]
    if in_joint_space:
        step = np.linalg.norm(np.diff(q, axis=0), axis=1)
    else:
        step = np.linalg.norm(np.diff(p, axis=0), axis=1) + _ARM_OF_ROTATION * angle_between(
            R[:-1], R[1:]
        )
    way = np.append(0.0, np.cumsum(step))
    share = way / way[-1] if way[-1] > 0 else np.linspace(0.0, 1.0, len(way))
    if in_joint_space:
        straight = model.tcp_pose(q[0] + share[:, None] * (q[-1] - q[0]))
        p_move = straight[:, :3, 3]
        R_move = straight[:, :3, :3]
    else:
        p_move = p[0] + share[:, None] * (p[-1] - p[0])
        R_move = turned(R[0], R[-1], share)
    return float(np.linalg.norm(p_move - p, axis=1).max()), float(angle_between(R_move, R).max())
