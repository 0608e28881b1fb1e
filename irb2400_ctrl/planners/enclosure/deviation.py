"""How far a motion is from the stated way-points, and from the singularities, over the whole path:
upper bounds.

The TCP stays within the hull of three points per cell (`tcp_path`), and the distance from a
straight side is convex: it is largest at one of them. Cells whose bound lies above what is reached
somewhere are cut further.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.complex_disc import disc_function
from irb2400_ctrl.planners.enclosure.parabolas import parabolas
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import ROTATION_LENGTH, TaskCurve

# cells are cut until what a parabola may miss is below this [m, rad]
_POSITION = 1e-8
_AXIS = 1e-6
# cells are cut further where the bound lies above the largest sample by more than this part,
# and this [m, rad]
_ABOVE = 2e-3
_SLACK = 2e-8
_AXIS_SLACK = 2e-6
_ROUNDS = 12


@dataclass(frozen=True)
class Deviation:
    """Upper bounds of the distances between the motion and the polygon of way-points."""

    position: float
    """distance of the TCP from the polygon, at any time [m]"""
    axis: float
    """angle between the tool axis and the one stated at the nearest place of the polygon, at any
    time [rad]"""
    corner: float
    """distance of any way-point from the motion [m]"""

    @property
    def largest(self) -> float:
        """Both ways: motion from polygon, way-point from motion [m]."""
        return max(self.position, self.corner)


def deviation(tcp: TcpPath, orientation: Orientation, followed: Followed) -> Deviation:
    """Bound the distances over the continuous path."""
    knots = followed.joints.knots
    ends = np.stack([knots[:-1], knots[1:]])
    missed = [enclosed.miss for enclosed in tcp.enclosed(ends)]
    parts = (
        np.ceil(np.cbrt(np.maximum(missed[0] / _POSITION, missed[1] / _AXIS)))
        .clip(1, 10_000)
        .astype(int)
    )
    cells = _cut(ends, parts)
    largest = np.zeros(2)
    sampled = np.zeros(2)
    for last in range(_ROUNDS):
        above, reached = _bounds(tcp, orientation, followed, cells)
        sampled = np.maximum(sampled, reached.max(axis=1))
        wide = (above > (1 + _ABOVE) * sampled[:, None] + np.array([[_SLACK], [_AXIS_SLACK]])).any(
            axis=0
        )
        if last == _ROUNDS - 1:
            wide[:] = False
        largest = np.maximum(largest, above[:, ~wide].max(axis=1, initial=0.0))
        if not wide.any():
            break
        cells = _cut(cells[:, wide], np.full(int(wide.sum()), 4))
    return Deviation(float(largest[0]), float(largest[1]), _corners(tcp, orientation, followed))


def _cut(cells: Array, parts: Integers) -> Array:
    """Start and end (2, m) of cells cut into equal parts."""
    number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    start = np.repeat(cells[0], parts)
    width = np.repeat((cells[1] - cells[0]) / parts, parts)
    whole = np.repeat(cells[1], parts)
    # the last part ends exactly where the cell does
    ends = np.where(number + 1 == np.repeat(parts, parts), whole, start + (number + 1) * width)
    return np.stack([start + number * width, ends])


def _bounds(
    tcp: TcpPath, orientation: Orientation, followed: Followed, cells: Array
) -> tuple[Array, Array]:
    """Upper bounds of distance and angle in the cells, and values that are reached there, each (2,
    m)."""
    curve = orientation.curve
    kept = _kept(curve)
    corners = curve.path.position[kept]
    position, axis = tcp.enclosed(cells)
    P = position.points
    A = axis.points
    both = np.concatenate([P, ROTATION_LENGTH * A], axis=2)
    stated = curve.path.tool_axis(orientation.spindle)[kept]
    stated_both = np.hstack([corners, ROTATION_LENGTH * stated])
    u = np.interp(cells.mean(axis=0), followed.joints.knots, followed.u)
    point = np.searchsorted(kept, curve.origin[np.minimum(u.astype(int), curve.segments - 1)])
    m = len(u)
    most = np.full(m, np.inf)
    angle = np.full(m, np.pi)
    held = np.zeros(m)
    nearest = np.full(m, np.inf)
    reached = np.full((2, m), np.inf)
    for shift in (-1, 0, 1):
        k = np.clip(point + shift, 1, len(kept) - 1)
        d = np.stack([_to_segment(P[:, i], corners[k - 1], corners[k])[0] for i in range(3)])
        most = np.minimum(most, d.max(axis=0) + position.miss)
        reached = np.minimum(reached, d[::2])
        # the place by position and direction together, so that turning on the spot has a place, too
        feet = [_to_segment(both[:, i], stated_both[k - 1], stated_both[k]) for i in (0, 2)]
        lines = [stated[k - 1] + t[:, None] * (stated[k] - stated[k - 1]) for _, t in feet]
        turned, shown = _angle_to_line(A, axis.miss, lines[0], lines[1])
        gap = feet[0][0] + feet[1][0]
        better = gap < nearest
        angle = np.where(better, turned, angle)
        held = np.where(better, shown, held)
        nearest = np.minimum(gap, nearest)
    return np.stack([most, angle]), np.stack([reached.max(axis=0), held])


def _angle_to_line(A: Array, miss: Array, first: Array, last: Array) -> tuple[Array, Array]:
    """Largest angle between a unit vector, near the parabola A, and one that goes from `first`
    straight to `last`.

    |a x l| is the norm of a cubic, at most that of its largest Bernstein coefficient. Also the
    angle at the ends.
    """
    cubic = bernstein.product(A, bernstein.linear(first, last), np.cross)
    origin = np.zeros_like(first)
    shortest = np.maximum(_to_segment(origin, first, last)[0], 1e-12)
    longest = np.maximum(np.linalg.norm(first, axis=1), np.linalg.norm(last, axis=1))
    size = np.linalg.norm(cubic, axis=2)
    sine = (size.max(axis=1) + miss * longest) / shortest
    along = (
        np.min([(A[:, i] * line).sum(axis=1) for i in range(3) for line in (first, last)], axis=0)
        - miss
    )
    ends = np.maximum(
        size[:, 0] / np.linalg.norm(first, axis=1), size[:, 3] / np.linalg.norm(last, axis=1)
    )
    # both on the same side: the angle is that of the sine
    bound = np.where((along > 0) & (sine < 1), np.arcsin(np.minimum(sine, 1.0)), np.pi)
    return bound, np.arcsin(np.minimum(ends, 1.0))


def _corners(tcp: TcpPath, orientation: Orientation, followed: Followed) -> float:
    """Largest distance of a way-point from the motion: Newton's method from its place on the curve,
    all at once."""
    curve = orientation.curve
    joints = followed.joints
    goal = curve.path.position
    kept = _kept(curve)
    # a way-point that was left out repeats the one before
    place = np.searchsorted(kept, np.arange(len(goal)), side="right") - 1
    ends = np.searchsorted(curve.origin, kept, side="right").astype(float)
    s = np.interp(ends[place], followed.u, joints.knots)
    best = np.full(len(goal), np.inf)
    gap = np.diff(joints.knots, prepend=joints.knots[0], append=joints.knots[-1])
    near = np.maximum(gap[:-1], gap[1:])[
        np.clip(np.searchsorted(joints.knots, s), 0, len(joints.knots) - 1)
    ]
    reach = np.maximum(near, curve.tolerance)
    for _ in range(5):
        away = goal - tcp.pose(s)[0]
        # any place on the motion bounds the distance from above
        best = np.minimum(best, np.linalg.norm(away, axis=1))
        rate = tcp.velocity(s, joints.piece(s))
        step = (away * rate).sum(axis=1) / np.maximum((rate**2).sum(axis=1), 1e-12)
        s = np.clip(s + np.clip(step, -reach, reach), joints.knots[0], joints.knots[-1])
    return float(best.max())


def _kept(curve: TaskCurve) -> Integers:
    """Numbers of the way-points that the curve was made from: repeated ones are left out."""
    return np.unique(np.concatenate([[0], curve.origin]))


def _to_segment(p: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """Distance of points from segments and the foot's parameter 0…1."""
    side = b - a
    length2 = np.maximum((side**2).sum(axis=1), 1e-30)
    t = np.clip(((p - a) * side).sum(axis=1) / length2, 0, 1)
    return np.linalg.norm(p - a - t[:, None] * side, axis=1), t


def singularity_margins(model: Model, followed: Followed) -> dict[str, float]:
    """Lower bounds of |sin q5| [-], |r| [m] and |k| [m] (eqs. 34-36) that hold at every point of
    the path."""
    factors = model.function("singularity_factors")
    value = compile_function(factors)
    radius = compile_function(disc_function(factors))
    coefficients, remainder = parabolas(
        followed.joints,
        followed.joints.knots,
        lambda q, dq, ddq: value.map(q),
        lambda q, dq, ddq, r, dr, ddr: radius.map(q, r),
    )
    lower = bernstein.least_size(coefficients[0]) - remainder[0]
    smallest = np.maximum(lower.min(axis=0), 0.0)
    return dict(zip(NAMES, map(float, smallest), strict=True))
