"""`AxisBounds`: what is sure of an axis that carries the part or the arm, over all times of the
rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.reference_bounds import ReferenceBounds
from irb2400_ctrl.trajectory import Trajectory

# of t^3 (10 - 15 t + 6 t^2): largest first, second and third derivative
_PEAKS = (15 / 8, 10 / np.sqrt(3), 60.0)
# room for what cubics between rows swing above it
_ROOM = 1.02


@dataclass(frozen=True)
class AxisBounds:
    """Upper bounds of the rows of one axis as they are read, and its limits; metres in place of
    radians where it is a rail."""

    least: float
    most: float
    """places that it stays between [rad]"""
    speed: float
    """largest |ed| over its limit"""
    acceleration: float
    """largest |edd| over its limit"""
    speed_limit: float
    """[rad/s]"""
    acceleration_limit: float
    """[rad/s2]"""
    slides: bool = False
    """whether it is a rail"""

    def summary(self, name: str) -> dict[str, Any]:
        """Its entry in `plan.json`."""
        unit, one = ("mm", 1e-3) if self.slides else ("deg", np.pi / 180)
        return {
            "name": name,
            f"between_{unit}": [self.least / one, self.most / one],
            "max_speed_ratio": self.speed,
            "max_acceleration_ratio": self.acceleration,
            f"speed_limit_{unit}_s": self.speed_limit / one,
            f"acceleration_limit_{unit}_s2": self.acceleration_limit / one,
        }


def stay_in_range(axes: ExternalAxes, bounds: Sequence[AxisBounds]) -> None:
    """Refuse a motion on which an axis leaves its range.

    Raises:
        UnreachableError: says which, and by how much.
    """
    for j, found in enumerate(bounds):
        beyond = max(float(axes.low[j]) - found.least, found.most - float(axes.high[j]))
        if beyond > 1e-9:
            unit, one = ("mm", 1e-3) if found.slides else ("deg", np.pi / 180)
            low, high = np.array([axes.low[j], axes.high[j]]) / one
            raise UnreachableError(
                f"{axes.names[j]} would go from {found.least / one:.2f} to "
                f"{found.most / one:.2f} {unit}, expected {low:g} to {high:g} {unit}; widen its "
                "range, or state a place at which it stands"
            )


def turn(axes: ExternalAxes, start: Array, end: Array, rate: float) -> Trajectory:
    """The axes alone from rest to rest, together, within their limits: t^3 (10 - 15 t + 6 t^2).

    Args:
        start, end: places (k,) [rad, m of a rail].
        rate: rows per second [1/s].
    """
    way = np.abs(end - start)
    needed = [
        _PEAKS[0] * way / axes.speed,
        np.sqrt(_PEAKS[1] * way / axes.acceleration),
        np.cbrt(_PEAKS[2] * way / axes.jerk),
    ]
    rows = max(int(np.ceil(_ROOM * float(np.max(needed)) * rate)), 2)
    while True:
        found = _quintic(start, end, rows, rate, tuple(range(axes.slides)))
        bounds = _of_rows(found, axes.speed, axes.acceleration)
        if max(max(axis.speed, axis.acceleration) for axis in bounds) <= 1:
            return found
        rows = int(np.ceil(_ROOM * rows)) + 1


def _quintic(
    start: Array, end: Array, rows: int, rate: float, lengths: tuple[int, ...]
) -> Trajectory:
    t = np.linspace(0, 1, rows + 1)[:, None]
    T = rows / rate
    way = end - start
    e = start + way * t**3 * (10 - 15 * t + 6 * t**2)
    ed = way * 30 * t**2 * (1 - t) ** 2 / T
    edd = way * 60 * t * (1 - t) * (1 - 2 * t) / T**2
    time = np.arange(rows + 1) / rate
    return Trajectory(time, e, ed, edd, lengths=lengths, check_speeds=False).as_written()


def _of_rows(rows: Trajectory, speed: Array, acceleration: Array) -> tuple[AxisBounds, ...]:
    """Exact, of the cubics between rows that have their angles and speeds."""
    places = JointPath.hermite(rows.time, rows.q, rows.qd)
    ends = rows.time[:-1], rows.time[1:]
    piece = np.arange(len(rows.time) - 1)
    bend = np.maximum(*(np.abs(places.on_piece(at, piece, 2)) for at in ends))
    h = np.diff(rows.time)[:, None]
    first, second = (places.on_piece(ends[0], piece, k) for k in (1, 2))
    slope = bernstein.leaving(first, second * h, places.on_piece(ends[1], piece, 1))
    bounds = ReferenceBounds(rows.time, bend, bernstein.largest_size(slope), np.zeros_like(bend))
    limits = MotionLimits(speed, acceleration, np.full_like(speed, np.inf))
    return axis_bounds(places, bounds, limits, 0, rows.lengths)


def worst_axis(plans: Sequence[AxisBounds], turns: Sequence[Trajectory], column: int) -> AxisBounds:
    """Of one axis in several motions one after another, the turns between them included.

    Args:
        plans: in the motions in which it moves; at least one.
        turns: rows between them.
        column: the axis in those.
    """
    first = plans[0]
    every = list(plans)
    for rows in turns:
        speed = np.full(rows.q.shape[1], np.inf)
        acceleration = speed.copy()
        speed[column] = first.speed_limit
        acceleration[column] = first.acceleration_limit
        every.append(_of_rows(rows, speed, acceleration)[column])
    return replace(
        first,
        least=min(axis.least for axis in every),
        most=max(axis.most for axis in every),
        speed=max(axis.speed for axis in every),
        acceleration=max(axis.acceleration for axis in every),
    )


def axis_bounds(
    places: JointPath,
    bounds: ReferenceBounds,
    limits: MotionLimits,
    n: int,
    lengths: tuple[int, ...] = (),
) -> tuple[AxisBounds, ...]:
    """Of the axes behind the arm's n joints.

    Args:
        places: where all axes are over the time.
        bounds: of their speed, and of the acceleration where the arm has its torque.
        limits: with those of these axes.
        lengths: columns of rails.
    """
    h = np.diff(places.knots)[:, None]
    low, high = bernstein.hull(bernstein.from_powers(places.coefficients[:, :, n:], h))
    found = []
    for j in range(places.n - n):
        limit = (float(limits.qd_max[n + j]), float(limits.tau_max[n + j]))
        found.append(
            AxisBounds(
                least=float(low[:, j].min()),
                most=float(high[:, j].max()),
                speed=float(bounds.speed[:, n + j].max()) / limit[0],
                acceleration=float(bounds.torque[:, n + j].max()) / limit[1],
                speed_limit=limit[0],
                acceleration_limit=limit[1],
                slides=n + j in lengths,
            )
        )
    return tuple(found)
