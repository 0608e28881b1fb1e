"""Pieces to one motion: fitted into the limits, joined by jerk-limited moves, stretched to the
wanted time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.excitation.feasible import (
    SHARE,
    Extent,
    between,
    dense_extent,
    extent,
    with_share,
)
from irb2400_ctrl.excitation.segments import Piece
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.joint_move import joint_move
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.trajectory.trajectory import RATE

LOOK = 100.0
"""[Hz] at which candidates are looked at; the whole motion is looked at densely in the end"""


def stretched(course: Trajectory, duration: float) -> Trajectory:
    """The same course in another time [s], rounded to whole rows."""
    rows = round(duration * RATE)
    time = np.arange(rows + 1) / RATE
    factor = course.duration / time[-1]
    q, qd, qdd = between(course, time * factor)
    return resting(time, q, qd * factor, qdd * factor**2)


def resting(time: Array, q: Array, qd: Array, qdd: Array) -> Trajectory:
    """A course whose ends are exactly at rest, whatever rounding left there.

    Args:
        time: [s], shape (m,).
        q: [rad], shape (m, n).
        qd: [rad/s], shape (m, n).
        qdd: [rad/s2], shape (m, n).
    """
    qd = qd.copy()
    qdd = qdd.copy()
    qd[[0, -1]] = 0.0
    qdd[[0, -1]] = 0.0
    return Trajectory(time, q, qd, qdd)


class Workshop:
    """Makes motions for one robot."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.model = Model(robot)
        self.transfers = Model(with_share(robot))

    def fitted(self, piece: Piece, duration: float) -> Piece | None:
        """The piece with amplitudes made smaller until it is inside all limits; None if even a
        small one is not."""
        time = np.arange(round(duration * LOOK) + 1) / LOOK
        if not self._holds(piece):
            return None
        for factor in (1.0, 0.85, 0.7, 0.55, 0.4, 0.28, 0.2):
            tried = piece.scaled(factor)
            found = extent(self.model, *tried.states(duration, time))
            # a little room for what lies between the instants
            driven = max(found.speed, found.acceleration) < 0.95
            if found.inside and found.torque < 0.97 * SHARE and driven:
                return tried
        return None

    def _holds(self, piece: Piece) -> bool:
        zero = np.zeros((1, self.robot.n))
        return extent(self.model, piece.centre[None], zero, zero).inside

    def course(self, piece: Piece, duration: float) -> Trajectory:
        """A piece alone."""
        time = np.arange(round(duration * RATE) + 1) / RATE
        return Trajectory(time, *piece.states(float(time[-1]), time))

    def joined(self, pieces: Sequence[Piece], duration: float) -> Trajectory:
        """Pieces of the same duration one after another, with the fastest moves between them.

        Raises:
            InfeasibleError: no move between two pieces stays inside the limits.
        """
        parts: list[tuple[Array, Array, Array]] = []
        for k, piece in enumerate(pieces):
            if k:
                move = joint_move(self.transfers, pieces[k - 1].centre, piece.centre, rate=RATE)
                parts.append((move.q[1:], move.qd[1:], move.qdd[1:]))
            course = self.course(piece, duration)
            first = 1 if k else 0
            parts.append((course.q[first:], course.qd[first:], course.qdd[first:]))
        q, qd, qdd = (np.concatenate([part[i] for part in parts]) for i in range(3))
        return resting(np.arange(len(q)) / RATE, q, qd, qdd)

    def filling(self, pieces: Sequence[Piece], duration: float, seconds: float) -> Trajectory:
        """Pieces joined to a motion of `seconds`.

        Args:
            pieces: one after another.
            duration: of a piece to begin with [s].
            seconds: that they shall fill [s].

        Raises:
            InfeasibleError: the limits leave no such motion.
        """
        for _ in range(4):
            course = self.joined(pieces, duration)
            over = course.duration - seconds
            if over <= 0:
                break
            duration -= over / len(pieces) + 0.01
            fitted = [self.fitted(piece, duration) for piece in pieces]
            if duration < 2.0 or any(piece is None for piece in fitted):
                raise InfeasibleError(
                    f"the moves between {len(pieces)} pieces leave no room in {seconds:g} s"
                )
            pieces = [piece for piece in fitted if piece is not None]
        return self.within(stretched(course, max(seconds, course.duration)))

    def within(self, course: Trajectory) -> Trajectory:
        """The course slowed down until it is inside the limits at every instant looked at.

        Raises:
            InfeasibleError: slowing down does not help.
        """
        for _ in range(25):
            found = self.extent(course)
            if found.inside:
                return course
            course = stretched(course, 1.04 * course.duration)
        raise InfeasibleError(
            f"no slower motion is inside the limits: torque {100 * found.torque:.0f} % of its "
            f"limit, acceleration {100 * found.acceleration:.0f} %, "
            f"joint box {np.degrees(found.box):.1f} deg, height {found.height:.2f} m, radius "
            f"{found.radius:.2f} m"
        )

    def extent(self, course: Trajectory) -> Extent:
        """How far a course goes, looked at densely."""
        return dense_extent(self.model, course)

    def recorded(self, course: Trajectory, name: str = "motion") -> PreparedLog:
        """The course as diagnosis sees it in a log of a real arm (that sticks when it turns), free
        of noise and lag.

        Without `q_ref`, so that the rows about each reversal count as unknown, as they do on such
        an arm.
        """
        tau = self.model.inverse_dynamics(course.q, course.qd, course.qdd)
        return prepare(Log(time=course.time, q=course.q, tau=tau, name=name))
