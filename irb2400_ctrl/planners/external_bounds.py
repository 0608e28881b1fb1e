"""`AxisBounds`: what is sure of an axis that carries the part, over all times of the rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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
    """Upper bounds of the rows of one axis as they are read, and its limits."""

    least: float
    most: float
    """angles that it stays between [rad]"""
    speed: float
    """largest |ed| over its limit"""
    acceleration: float
    """largest |edd| over its limit"""
    speed_limit: float
    """[rad/s]"""
    acceleration_limit: float
    """[rad/s2]"""

    def summary(self, name: str) -> dict[str, Any]:
        """Its entry in `plan.json`."""
        return {
            "name": name,
            "between_deg": [float(np.degrees(v)) for v in (self.least, self.most)],
            "max_speed_ratio": self.speed,
            "max_acceleration_ratio": self.acceleration,
            "speed_limit_deg_s": float(np.degrees(self.speed_limit)),
            "acceleration_limit_deg_s2": float(np.degrees(self.acceleration_limit)),
        }


def stay_in_range(axes: ExternalAxes, bounds: Sequence[AxisBounds]) -> None:
    """Refuse a motion on which an axis leaves its range.

    Raises:
        UnreachableError: says which, and by how much.
    """
    for j, found in enumerate(bounds):
        beyond = max(float(axes.low[j]) - found.least, found.most - float(axes.high[j]))
        if beyond > 1e-9:
            low, high = np.degrees([axes.low[j], axes.high[j]])
            raise UnreachableError(
                f"{axes.names[j]} would turn from {np.degrees(found.least):.2f} to "
                f"{np.degrees(found.most):.2f} deg, expected {low:g} to {high:g} deg; widen its "
                "range, or state angles at which it stands"
            )


def turn(axes: ExternalAxes, start: Array, end: Array, rate: float) -> Trajectory:
    """The axes alone from rest to rest, together, within their limits: t^3 (10 - 15 t + 6 t^2).

    Args:
        start, end: angles (k,) [rad].
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
        found = _quintic(start, end, rows, rate)
        bounds = _of_rows(found, axes.speed, axes.acceleration)
        if max(max(axis.speed, axis.acceleration) for axis in bounds) <= 1:
            return found
        rows = int(np.ceil(_ROOM * rows)) + 1


def _quintic(start: Array, end: Array, rows: int, rate: float) -> Trajectory:
    t = np.linspace(0, 1, rows + 1)[:, None]
    T = rows / rate
    way = end - start
    e = start + way * t**3 * (10 - 15 * t + 6 * t**2)
    ed = way * 30 * t**2 * (1 - t) ** 2 / T
    edd = way * 60 * t * (1 - t) * (1 - 2 * t) / T**2
    time = np.arange(rows + 1) / rate
    return Trajectory(time, e, ed, edd, check_speeds=False).as_written()


def _of_rows(rows: Trajectory, speed: Array, acceleration: Array) -> tuple[AxisBounds, ...]:
    """Exact, of the cubics between rows that have their angles and speeds."""
    places = JointPath.hermite(rows.time, rows.q, rows.qd)
    ends = rows.time[:-1], rows.time[1:]
    piece = np.arange(len(rows.time) - 1)
    bend = np.maximum(*(np.abs(places.on_piece(at, piece, 2)) for at in ends))
    h = np.diff(rows.time)[:, None]
    first, second = (places.on_piece(ends[0], piece, k) for k in (1, 2))
    slope = bernstein.leaving(first, second * h, places.on_piece(ends[1], piece, 1))
    bounds = ReferenceBounds(rows.time, bend, bernstein.largest_size(slope))
    limits = MotionLimits(speed, acceleration, np.full_like(speed, np.inf))
    return axis_bounds(places, bounds, limits, 0)


def worst_axes(
    plans: Sequence[tuple[AxisBounds, ...]], turns: Sequence[Trajectory]
) -> tuple[AxisBounds, ...]:
    """Of several motions one after another, the turns between them included; none where nothing
    turns."""
    known = [found for found in plans if found]
    if not known:
        return ()
    speed = np.array([axis.speed_limit for axis in known[0]])
    acceleration = np.array([axis.acceleration_limit for axis in known[0]])
    every = [*known, *(_of_rows(rows, speed, acceleration) for rows in turns)]
    return tuple(
        AxisBounds(
            least=min(axis.least for axis in axes),
            most=max(axis.most for axis in axes),
            speed=max(axis.speed for axis in axes),
            acceleration=max(axis.acceleration for axis in axes),
            speed_limit=axes[0].speed_limit,
            acceleration_limit=axes[0].acceleration_limit,
        )
        for axes in zip(*every, strict=True)
    )


def axis_bounds(
    places: JointPath, bounds: ReferenceBounds, limits: MotionLimits, n: int
) -> tuple[AxisBounds, ...]:
    """Of the axes behind the arm's n joints.

    Args:
        places: where all axes are over the time.
        bounds: of their speed, and of the acceleration where the arm has its torque.
        limits: with those of these axes.
    """
    h = np.diff(places.knots)[:, None]
    value, slope, bend, third = places.coefficients[:, :, n:]
    b1 = value + slope * h / 3
    b2 = value + 2 * slope * h / 3 + bend * h**2 / 3
    b3 = value + slope * h + bend * h**2 + third * h**3
    low, high = bernstein.hull(np.stack([value, b1, b2, b3], axis=1))
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
            )
        )
    return tuple(found)
