"""`ReferenceBounds`: torque, speed and acceleration of a sampled reference over all times, bounded.

The reference is a motion with the time as its parameter, sdot = 1 and sddot = 0: it is enclosed as
any path (`enclosure.cells`), cut at the rows and wherever a joint turns back. No law and no solver
enters, only the numbers of the rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.cells import enclose, with_reversals
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointMotion
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.torque_bounds import timed_torque_bounds

# cells whose bound is above a limit are cut into so many parts, so often
_PARTS = 4
_ROUNDS = 2


@dataclass(frozen=True)
class ReferenceBounds:
    """Upper bounds in m cells of time, each within one interval between rows."""

    time: Array
    """ends of the cells [s], shape (m + 1,)"""
    torque: Array
    """|tau|, friction and effects included [Nm], shape (m, n); inf where there is no bound"""
    speed: Array
    """|qd| [rad/s], shape (m, n)"""
    acceleration: Array
    """|qdd| [rad/s2], shape (m, n); zero where no axis has a limit of it"""

    @property
    def largest(self) -> ReferenceBounds:
        """Of the whole motion as one cell."""
        parts = (self.torque, self.speed, self.acceleration)
        return ReferenceBounds(self.time[[0, -1]], *(part.max(axis=0)[None] for part in parts))

    def first(self, n: int) -> ReferenceBounds:
        """Those of the first n axes."""
        parts = (self.torque, self.speed, self.acceleration)
        return ReferenceBounds(self.time, *(part[:, :n] for part in parts))

    def torque_ratio(self, tau_max: Array) -> float:
        """Largest |tau| / tau_max; inf where nothing can be said."""
        return _largest(self.torque / tau_max)

    def velocity_ratio(self, qd_max: Array) -> float:
        """Largest |qd| / qd_max."""
        return _largest(self.speed / qd_max)

    def acceleration_ratio(self, qdd_max: Array) -> float:
        """Largest |qdd| / qdd_max; zero without a limit."""
        return _largest(self.acceleration / qdd_max)


class _Enclosed(NamedTuple):
    """Of `ReferenceBounds` what has to be enclosed."""

    time: Array
    torque: Array
    speed: Array


def reference_bounds(
    dynamics: PathDynamics, motion: JointMotion, limits: MotionLimits
) -> ReferenceBounds:
    """Bound what the arm needs for a motion over the time; cells are cut where a bound is above a
    limit.

    Args:
        dynamics: the arm's torque along the path.
        motion: over the time [s].
        limits: of torque [Nm], speed and acceleration, and of their rates.
    """
    s = with_reversals(motion, motion.knots)
    # what a law remembers of the way is not known in the middle of a motion
    remembers = any(law.memory is not None for law in dynamics.forms.laws)
    count = len(s) if remembers else bernstein.AT_ONCE
    parts = [
        _bounds(dynamics, motion, s[first : first + count + 1], limits)
        for first in range(0, len(s) - 1, count)
    ]
    s = np.concatenate([s[:1], *(part.time[1:] for part in parts)])
    torque, speed = (np.concatenate([getattr(p, k) for p in parts]) for k in ("torque", "speed"))
    for end in (0, -1):
        torque[end] = np.maximum(torque[end], _at_rest(dynamics, motion, s[end]))
    if dynamics.irregular:
        torque[:, : dynamics.model.robot.n] = np.inf
    return ReferenceBounds(s, torque, speed, _bend(motion, s, limits))


def _bend(motion: JointMotion, s: Array, limits: MotionLimits) -> Array:
    """|qdd| on cells: it goes straight between rows, so that the ends of a cell have its largest,
    shape (m, n)."""
    n = len(limits.qdd_max)
    if not np.isfinite(limits.qdd_max).any():
        return np.broadcast_to(0.0, (len(s) - 1, n))
    piece = motion.piece((s[:-1] + s[1:]) / 2)
    first, last = (np.abs(motion.on_piece(at, piece, 2)) for at in (s[:-1], s[1:]))
    return np.asarray(np.maximum(first, last))


def _bounds(
    dynamics: PathDynamics, motion: JointMotion, s: Array, limits: MotionLimits
) -> _Enclosed:
    """Between some of the rows, which do not depend on the others."""
    torque, speed = _enclosed(dynamics, motion, s)
    for _ in range(_ROUNDS):
        wide = ~((torque <= limits.tau_max) & (speed <= limits.qd_max)).all(axis=1)
        if not wide.any():
            break
        parts = np.where(wide, _PARTS, 1)
        s = divided(s, parts)
        new = np.repeat(wide, parts)
        torque = np.repeat(torque, parts, axis=0)
        speed = np.repeat(speed, parts, axis=0)
        if dynamics.local:
            cut = motion.taken(s[:-1][new], s[1:][new])
            torque[new], speed[new] = _enclosed(dynamics, cut, cut.knots)
        else:
            torque, speed = _enclosed(dynamics, motion, s)
    return _Enclosed(s, torque, speed)


def _enclosed(dynamics: PathDynamics, motion: JointMotion, s: Array) -> tuple[Array, Array]:
    """Bounds of |tau| and |qd| on cells, each (m, n)."""
    cells = enclose(dynamics, motion, s)
    above, below = timed_torque_bounds(cells, dynamics.friction)
    return np.maximum(above, -below), bernstein.largest_size(cells.speed)


def _at_rest(dynamics: PathDynamics, motion: JointMotion, time: float) -> Array:
    """|tau| at an end, where friction has no direction yet [Nm], shape (n,)."""
    at = np.array([time])
    _, b, e, _, c, *_ = dynamics.coefficients(*(motion(at, order) for order in (0, 1, 2)))
    return np.asarray(np.abs(b + e + c)[0])


def _largest(ratio: Array) -> float:
    """A bound that could not be computed holds nothing."""
    return float(np.where(np.isnan(ratio), np.inf, ratio).max())
