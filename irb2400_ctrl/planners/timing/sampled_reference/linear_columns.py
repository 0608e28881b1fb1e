"""`LinearColumns`: angles, speeds and accelerations that go each straight from row to row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.joint_path import JointPath


@dataclass(frozen=True)
class LinearColumns:
    """Three columns over the time, a `JointMotion` to enclose; none is the slope of another."""

    columns: tuple[JointPath, JointPath, JointPath]
    """angles [rad], speeds [rad/s], accelerations [rad/s2], each in straight pieces"""

    @classmethod
    def of(cls, time: Array, q: Array, qd: Array, qdd: Array) -> LinearColumns:
        """Through rows at the times (m,) [s]; the columns (m, n).

        Args:
            time: [s].
            q: [rad].
            qd: [rad/s].
            qdd: [rad/s2].
        """
        return cls(
            (
                JointPath.straight(time, q),
                JointPath.straight(time, qd),
                JointPath.straight(time, qdd),
            )
        )

    @property
    def knots(self) -> Array:
        """Times of the rows [s], shape (m,)."""
        return self.columns[0].knots

    def piece(self, s: Array) -> npt.NDArray[np.int64]:
        """Number of the row that each time follows."""
        return self.columns[0].piece(s)

    def __call__(self, s: Array, order: int = 0) -> Array:
        """Angles, speeds or accelerations at the times (k,), shape (k, n)."""
        s = np.atleast_1d(np.asarray(s, dtype=float))
        return self.on_piece(s, self.piece(s), order)

    def on_piece(self, s: Array, piece: npt.NDArray[np.int64], order: int = 0) -> Array:
        """The same with the row chosen by the caller; order 3 is the slope of the accelerations."""
        if order > 2:
            return self.columns[2].on_piece(s, piece, 1)
        return self.columns[order].on_piece(s, piece)

    def taken(self, first: Array, last: Array) -> LinearColumns:
        """The stretches between the times first and last (k,), each between two rows, put one after
        another."""
        q, qd, qdd = (column.taken(first, last) for column in self.columns)
        return LinearColumns((q, qd, qdd))

    def spread(self, s: Array, R: Array) -> tuple[Array, Array, Array]:
        """By how much each column differs at most from its values at s on circles of radius R."""
        q, qd, qdd = (np.abs(column(s, 1)) * R[:, None] for column in self.columns)
        return q, qd, qdd

    def reversals(self) -> Array:
        """Times between rows at which a speed is zero, sorted [s]."""
        start, slope = self.columns[1].coefficients[:2]
        with np.errstate(invalid="ignore", divide="ignore"):
            after = -start / slope
        inside = (after > 0) & (after < np.diff(self.knots)[:, None])
        return np.unique((self.knots[:-1, None] + after)[inside])
