"""Time-optimal timing of a path with a torque bound that holds at every instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits, speed_bounds
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.torque_constraints import Linearisation, TorqueConstraints
from irb2400_ctrl.planners.timing.two_pass import Passed, two_pass

# further passes stop when they gain less than this part of the duration
_GAIN = 2e-4
# room above the speeds of the pass before, pass by pass: wide to find them, tight to bound viscous
# friction well
_ROOM = (1.6, 1.4, 1.1, 1.03, 1.02, 1.02, 1.02)
_TIGHT = 1.2
# x that no joint limits [m2/s2]
_FAST = 1e9


def time_path(
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    feed_bound: Array | None = None,
    extra: Array | None = None,
) -> PiecewiseConstantLaw:
    """The fastest rest-to-rest time law whose constraints hold on every cell.

    Two rough passes guess speeds; each later one is safe by itself and takes its tangents and
    chords at the speeds of the one before. The fastest of the safe ones is returned.

    Args:
        cells: the enclosed path.
        limits: speed, torque and acceleration limits.
        friction: table of eq. 54, shape (n, 4).
        feed_bound: bound of x = sdot^2 within each cell, shape (m,), or at both ends, (2, m).
        extra: torque to hold back, see `TorqueConstraints`.

    Raises:
        InfeasibleError: no motion within the limits; says where, and which axis lacks what.
    """
    bound = np.minimum(speed_bounds(cells, limits.qd_max, feed_bound), _FAST)
    bound[[0, -1]] = 0.0
    passes = _Passes(cells, limits, friction, bound, extra)
    near = passes.guess()
    floor = True
    best: Passed | None = None
    duration = np.inf
    for room in _ROOM:
        passed = passes.safe(near, room, floor)
        if passed.infeasible_cell is not None:
            # too bold: without the floor, then without the guess
            if floor and near is not None:
                floor = False
            elif best is None and near is not None:
                near = None
            elif best is None:
                raise passes.explained(passed.infeasible_cell)
            else:
                break
            continue
        new = PiecewiseConstantLaw(cells.s, passed.x).duration
        gained = duration - new
        if new <= duration:
            best = passed
            duration = new
        if room < _TIGHT and not gained > _GAIN * new:
            break
        near = passed.x
        floor = True
    if best is None:
        raise passes.explained(passed.infeasible_cell or 0)
    if not np.isfinite(duration):
        raise passes.explained(int(np.argmin(best.x[1:-1])))
    return PiecewiseConstantLaw(cells.s, best.x)


@dataclass(frozen=True)
class _Passes:
    """The passes over one path: each maximises x under constraints that are linear in (u, x)."""

    cells: Cells
    limits: MotionLimits
    friction: Array
    bound: Array
    """of x at the grid points by speed and feed, shape (m + 1,)"""
    extra: Array | None = None

    def guess(self) -> Array | None:
        """Speeds to start from: two rough passes that leave the safe sides out; None where they
        find no motion."""
        h = self.cells.h
        still = np.zeros_like(self.bound)
        unbounded = np.full(len(h), np.inf)
        x = 0.25 * self.bound
        x = np.minimum(x, 4 * np.median(x) + 1e-9)
        for _ in range(2):
            mean = _mean(x)
            at = Linearisation(
                x_bar=mean,
                x_low=mean,
                x_high=1.2 * mean,
                u_max=unbounded,
                u_bar=np.diff(x) / (2 * h),
            )
            passed = self._passed(at, still, self.bound)
            if passed.infeasible_cell is not None:
                return None
            x = passed.x
        return x

    def safe(self, near: Array | None, room: float, floor: bool) -> Passed:
        """A pass whose motion keeps all limits on whole cells, linearised near known speeds.

        Args:
            near: x at the grid points; None where nothing is known.
            room: factor above them within which the motion is looked for.
            floor: whether it may not be slower than that factor below them, either: how slow a
                joint can be at most bounds Stribeck's peak.
        """
        h = self.cells.h
        low = np.zeros_like(self.bound)
        high = self.bound
        x = 0.25 * self.bound
        if near is not None:
            x = near
            high = np.minimum(self.bound, room * _widened(near) + 1e-30)
            if floor:
                low = near / room**2
        at = Linearisation(
            x_bar=_mean(x),
            x_low=np.minimum(low[:-1], low[1:]),
            x_high=np.maximum(high[:-1], high[1:]),
            u_max=_acceleration_bound(x, h),
            u_bar=np.diff(x) / (2 * h),
        )
        return self._passed(at, low, high)

    def _passed(self, at: Linearisation, low: Array, high: Array) -> Passed:
        constraints = TorqueConstraints(self.cells, self.limits, self.friction, at, self.extra)
        return two_pass(constraints, self.cells.h, low, high, constraints.blocks)

    def explained(self, cell: int) -> InfeasiblePointError:
        """Which axis cannot even hold the arm, at an infeasible cell or nearest to it; else which
        one cannot set off there, or is closest to that."""
        static = self.friction[:, 0]
        coulomb = self.friction[:, 1]
        limit = self.limits.tau_max
        held = self._needed(coulomb)
        ratio = held / limit
        heavy = np.flatnonzero(ratio.max(axis=1) > 1)
        if len(heavy):
            cell = int(heavy[np.argmin(np.abs(heavy - cell))])
            axis = int(np.argmax(ratio[cell]))
            said = f", axis {axis + 1} cannot hold the arm: needs {held[cell, axis]:,.0f} of "
            return self._lacking(cell, said + f"{limit[axis]:,.0f} Nm")
        needed = self._needed(np.maximum(static, coulomb))[cell]
        axis = int(np.argmax(needed / limit))
        torque = f"{needed[axis]:,.0f} of {limit[axis]:,.0f} Nm"
        if needed[axis] > limit[axis]:
            said = f", axis {axis + 1} cannot set off or turn back: with static friction it needs "
            return self._lacking(cell, said + torque)
        return InfeasiblePointError(
            float(self.cells.s[cell]),
            f" no acceleration keeps all axes within their torque limits; axis {axis + 1} "
            f"is closest, with {torque} to move slowly; round the corner there, or move the work "
            "frame",
        )

    def _needed(self, dry: Array) -> Array:
        """Torque of each axis to move slowly, with this dry friction, shape (m, n) [Nm]."""
        cells = self.cells
        above = cells.c_high.max(axis=1) + np.where(cells.forwards, dry, 0.0)
        below = cells.c_low.min(axis=1) - np.where(cells.backwards, dry, 0.0)
        return np.asarray(np.maximum(above, -below))

    def _lacking(self, cell: int, said: str) -> InfeasiblePointError:
        return InfeasiblePointError(
            float(self.cells.s[cell]),
            f"{said}; lighten the load, move the work frame, or raise torque_Nm (or the torque "
            "share, if it is below 1)",
        )


def remainder_share(
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    x: Array | None,
    feed_bound: Array | None = None,
) -> Array:
    """Largest part of a torque limit that the enclosure of each cell takes, at speeds x or at a
    guess, shape (m,)."""
    if x is None:
        bound = np.minimum(speed_bounds(cells, limits.qd_max, feed_bound), _FAST)
        bound[[0, -1]] = 0.0
        guess = _Passes(cells, limits, friction, bound).guess()
        x = 0.25 * bound if guess is None else guess
    high = np.maximum(x[:-1], x[1:])[:, None]
    r_a, r_b, r_e, r_c = cells.remainder
    rest = r_a * _acceleration_bound(x, cells.h)[:, None] + r_b * high + r_e * np.sqrt(high) + r_c
    return np.asarray((rest / limits.tau_max).max(axis=1))


def _widened(x: Array) -> Array:
    """Largest value among the neighbours within three grid points."""
    padded = np.pad(x, 3, mode="edge")
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, 7).max(axis=1))


def _acceleration_bound(x: Array, h: Array) -> Array:
    """Generous bound of |u| in each cell, from a motion nearby."""
    u = np.abs(np.diff(x)) / (2 * h)
    padded = np.pad(u, 5, mode="edge")
    nearby = np.lib.stride_tricks.sliding_window_view(padded, 11).max(axis=1)
    # where the speed hardly changes: a thousandth of x per cell
    return np.asarray(3 * nearby + 1e-3 * (x[:-1] + x[1:]) / h)


def _mean(x: Array) -> Array:
    """x in the middle of each cell, never zero, shape (m,)."""
    return np.maximum((x[:-1] + x[1:]) / 2, 1e-30)
