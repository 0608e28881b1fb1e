"""The rows of a plan as a RAPID module needs them: checked, with speeds, rests and crossings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid import rapid_data as data
from irb2400_ctrl.trajectory import Trajectory

Rows = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class PlanRows:
    """The plan row by row."""

    time: Array
    q: Array
    X_WT: Array
    """targets in the work object, of the rows that moves go to, shape (m, 4, 4)"""
    speeds: Array
    """between the rows, shape (n - 1, 2); where external axes go with the arm, two more columns are
    the speed of a rail [mm/s] and the largest of those that turn [deg/s]"""
    rest: Rows
    """rows that repeat the one before"""
    crossing: Rows
    """rows at the wrist singularity"""
    as_joints: Rows
    """rows to which the joints move, the tool not on a line"""
    stops: Rows
    """rows at which the arm stands"""
    tool: Integers
    """number of the tool, from 0, that the arm goes to each row with"""
    feeds: Array
    """programmed feed of the way to each row, inf where there is none [m/s], shape (n,)"""

    def pauses(self, before: int, row: int) -> bool:
        """Whether the arm only waits from one sample to the next."""
        return bool(self.rest[before + 1 : row + 1].all())


def row_flags(what: str, given: npt.NDArray[np.bool_] | None, count: int) -> Rows:
    """A copy of the flags of the plan's rows; none are set where none are given.

    Args:
        what: name of the flags, for the message.
        given: as the caller gave them.
        count: rows of the plan.

    Raises:
        InputError: not bool of shape (count,).
    """
    flags = np.zeros(count, dtype=bool)
    if given is not None:
        found = np.asarray(given)
        if found.shape != (count,) or found.dtype != np.bool_:
            raise InputError(
                f"RAPID: {what} is {found.dtype} {found.shape}, expected bool ({count},)"
            )
        flags |= found
    return flags


def checked(
    model: Model, motion: Trajectory | ArrayLike, angles: ArrayLike | None
) -> tuple[Array, Array]:
    if isinstance(motion, Trajectory):
        if angles is not None:
            raise InputError("RAPID: found a trajectory and angles besides, expected one of them")
        time = motion.time
        q = motion.q
    else:
        time = np.asarray(motion, dtype=float)
        q = np.asarray(angles, dtype=float)
    n = model.robot.n
    if n != 6:
        raise InputError(f"RAPID: found an arm of {n} axes, expected 6")
    if q.ndim != 2 or q.shape[1] != n or len(q) < 2 or time.shape != (len(q),):
        raise InputError(
            f"RAPID: found time {time.shape} and q {q.shape}, expected (m,) and (m, {n}) with m >= "
            "2"
        )
    if not (np.isfinite(time).all() and np.isfinite(q).all()):
        raise InputError("RAPID: time or q is not finite")
    if (np.diff(time) <= 0).any():
        raise InputError(
            f"RAPID: time does not increase at row {int(np.argmax(np.diff(time) <= 0)) + 2}"
        )
    excess = np.maximum(model.robot.q_min - q, q - model.robot.q_max)
    if excess.max() > 1e-6:
        row, axis = np.unravel_index(int(np.argmax(excess)), excess.shape)
        raise InputError(
            f"RAPID: axis {axis + 1} is outside its range at row {row + 1}: "
            f"{np.degrees(q[row, axis]):.2f} deg"
        )
    return time, q


def checked_feeds(feeds: ArrayLike | None, count: int) -> Array:
    """Programmed feeds of the ways to the plan's rows [m/s], shape (n,).

    Raises:
        InputError: not a positive number for each row.
    """
    if feeds is None:
        return np.full(count, np.inf)
    found = np.asarray(feeds, dtype=float)
    if found.shape != (count,) or not (found > 0).all():
        raise InputError(f"RAPID: feeds is {found.shape}, expected ({count},) positive numbers")
    return found


def wrist_rows(q: Array, given: npt.NDArray[np.bool_] | None) -> npt.NDArray[np.bool_]:
    """Rows next to a passage through the wrist singularity, shape (n,)."""
    if given is not None:
        crossing = row_flags("wrist_crossing", given, len(q))
        # the move that leaves a flagged row passes the singularity too
        flagged: npt.NDArray[np.bool_] = crossing | np.append(False, crossing[:-1])
        return flagged
    s5 = np.sin(q[:, 4])
    change = s5[1:] * s5[:-1] <= 0
    beside: npt.NDArray[np.bool_] = np.append(change, False) | np.append(False, change)
    return beside


def speeds_between(time: Array, X_BT: Array) -> Array:
    """Speed of the TCP and turning speed between the rows of the plan [mm/s, deg/s], shape (n - 1,
    2)."""
    p = X_BT[:, :3, 3]
    R = X_BT[:, :3, :3]
    way = np.column_stack(
        [
            1e3 * np.linalg.norm(np.diff(p, axis=0), axis=1),
            np.degrees(data.in_parts(data.angle_between, R[:-1], R[1:])),
        ]
    )
    found: Array = way / np.diff(time)[:, None]
    return found
