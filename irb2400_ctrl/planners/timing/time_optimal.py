"""Time-optimal timing of a path with a torque bound that holds at every instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits, speed_bounds
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.torque_constraints import Linearisation, torque_constraints
from irb2400_ctrl.planners.timing.two_pass import Passed, two_pass

Array = npt.NDArray[np.float64]

# further passes stop when they gain less than this part of the duration
_GAIN = 2e-4
# room above the speeds of the pass before, pass by pass: wide to find them, tight to bound viscous
# friction well
_ROOM = (1.6, 1.4, 1.1, 1.03, 1.02, 1.02, 1.02)
_TIGHT = 1.2


@dataclass(frozen=True)
class Timed:
    """A time law and how it was reached."""

    law: PiecewiseConstantLaw
    passes: int
    speed_bound: Array
    """bound of x at the grid points by speed and feed, shape (m + 1,)"""


def time_path(
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    feed_bound: Array | None = None,
    extra: Array | None = None,
) -> Timed:
    """The fastest rest-to-rest time law whose rows hold on every cell.

    Two rough passes guess speeds; each later one is safe by itself and takes its tangents and
    chords at the speeds of the one before. The fastest of the safe ones is returned.

    Args:
        cells: the enclosed path.
        limits: speed, torque and acceleration limits.
        friction: table of eq. 54, shape (n, 4).
        feed_bound: bound of x = sdot^2 within each cell, shape (m,).
        extra: torque to hold back, see `torque_constraints`.

    Raises:
        InfeasibleError: no motion within the limits; says where, and which axis lacks what.
    """
    h = cells.h
    m = len(cells.h)
    bound = speed_bounds(cells, limits.qd_max, feed_bound)
    bound[[0, -1]] = 0.0
    bound = np.minimum(bound, 1e9)
    still = np.zeros(m + 1)
    guess = _guess(cells, limits, friction, bound, extra)
    best: Passed | None = None
    duration = np.inf
    start = guess
    bold = True
    passes = 1
    for factor in _ROOM:
        low = still
        high = bound
        if start is not None:
            # room to grow above, a floor below that tells how slow a joint can be at most
            # (Stribeck's peak)
            high = np.minimum(bound, factor * _widened(start) + 1e-30)
            low = start / factor**2 if bold else still
        x = start if start is not None else 0.25 * bound
        at = Linearisation(
            x_bar=np.maximum((x[:-1] + x[1:]) / 2, 1e-30),
            x_low=np.minimum(low[:-1], low[1:]),
            x_high=np.maximum(high[:-1], high[1:]),
            u_max=_acceleration_bound(x, h),
            u_bar=np.diff(x) / (2 * h),
        )
        passed = two_pass(torque_constraints(cells, limits, friction, at, extra), h, low, high)
        passes += 1
        if passed.stuck is not None:
            # too bold: without the floor, then without the guess
            if bold and start is not None:
                bold = False
            elif best is None and start is not None:
                start = None
            elif best is None:
                raise _explain(cells, limits, friction, passed.stuck)
            else:
                break
            continue
        new = PiecewiseConstantLaw(cells.s, passed.x).duration
        gained = duration - new
        if new <= duration:
            best = passed
            duration = new
        if factor < _TIGHT and not gained > _GAIN * new:
            break
        start = passed.x
        bold = True
    if best is None:
        raise _explain(cells, limits, friction, 0 if passed.stuck is None else passed.stuck)
    if not np.isfinite(duration):
        raise _explain(cells, limits, friction, int(np.argmin(best.x[1:-1])))
    return Timed(PiecewiseConstantLaw(cells.s, best.x), passes, bound)


def _guess(
    cells: Cells, limits: MotionLimits, friction: Array, bound: Array, extra: Array | None
) -> Array | None:
    """Speeds to start from: two rough passes that leave the safe sides out."""
    x = 0.25 * bound
    m = len(cells.h)
    x = np.minimum(x, 4 * np.median(x) + 1e-9)
    for _ in range(2):
        mean = np.maximum((x[:-1] + x[1:]) / 2, 1e-30)
        at = Linearisation(mean, mean, 1.2 * mean, np.full(m, np.inf), np.diff(x) / (2 * cells.h))
        passed = two_pass(
            torque_constraints(cells, limits, friction, at, extra), cells.h, np.zeros(m + 1), bound
        )
        if passed.stuck is not None:
            return None
        x = passed.x
    return x


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
        bound = np.minimum(speed_bounds(cells, limits.qd_max, feed_bound), 1e9)
        bound[[0, -1]] = 0.0
        guess = _guess(cells, limits, friction, bound, None)
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


def _explain(cells: Cells, limits: MotionLimits, friction: Array, cell: int) -> InfeasibleError:
    """Which axis cannot even hold the arm, at the stuck cell or nearest to it."""
    forwards = np.where(cells.forwards, friction[:, 1], 0.0)
    backwards = np.where(cells.backwards, friction[:, 1], 0.0)
    above = cells.c_high.max(axis=1) + forwards
    below = cells.c_low.min(axis=1) - backwards
    needed = np.maximum(above, -below)
    ratio = needed / limits.tau_max
    heavy = np.flatnonzero(ratio.max(axis=1) > 1)
    if len(heavy):
        cell = int(heavy[np.argmin(np.abs(heavy - cell))])
        axis = int(np.argmax(ratio[cell]))
        return InfeasiblePointError(
            float(cells.s[cell]),
            f", axis {axis + 1} cannot hold the arm: needs {needed[cell, axis]:,.0f} of "
            f"{limits.tau_max[axis]:,.0f} Nm; lighten the load, move the work frame, or raise "
            "torque_Nm",
        )
    axis = int(np.argmax(ratio[cell]))
    return InfeasiblePointError(
        float(cells.s[cell]),
        f" no acceleration keeps all axes within their torque limits; axis {axis + 1} "
        f"is closest, with {needed[cell, axis]:,.0f} of {limits.tau_max[axis]:,.0f} Nm to move "
        "slowly; round the "
        "corner there, or move the work frame",
    )
