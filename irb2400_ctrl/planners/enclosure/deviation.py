"""How far a motion is from the stated way-points, and from the singularities, over the whole path:
upper bounds.

The TCP stays within the hull of three points per cell (`tcp_path`), and the distance from a
straight side is convex: it is largest at one of them. Cells whose bound lies above what is reached
somewhere are cut further.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask, inner_products, norms
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.complex_disc import disc_function
from irb2400_ctrl.planners.enclosure.parabolas import parabolas
from irb2400_ctrl.planners.enclosure.polygon_sides import Sides, kept_points, to_segment
from irb2400_ctrl.planners.enclosure.tcp_path import Enclosed, TcpPath
from irb2400_ctrl.planners.grids import cut
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import ROTATION_LENGTH

# cells are cut until what a parabola may miss is below this [m, rad]
_POSITION = 1e-8
_AXIS = 1e-6
# cells are cut further where the bound lies above the largest sample by more than this part,
# and this [m, rad]; at most so many cells
_ABOVE = np.array([[2e-3], [1e-2]])
_SLACK = np.array([[2e-8], [1e-5]])
_ROUNDS = 12
_MOST = 300_000


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


def deviation(
    tcp: TcpPath,
    orientation: Orientation,
    followed: Followed,
    along: tuple[Array, Array] | None = None,
) -> Deviation:
    """Bound the distances over the continuous path.

    Args:
        tcp: of the joints.
        orientation: what was asked for.
        followed: the joints, over their length or the time.
        along: places on them and the curve's parameter there, in between it is about linear;
            default those of the knots.
    """
    place, u = along or (followed.joints.knots, followed.u)
    knots = followed.joints.knots
    ends = np.stack([knots[:-1], knots[1:]])
    missed = tcp.missed(ends)
    parts = (
        np.ceil(np.cbrt(np.maximum(missed[0] / _POSITION, missed[1] / _AXIS)))
        .clip(1, 10_000)
        .astype(int)
    )
    cells = cut(ends, parts)
    largest = np.zeros(2)
    sampled = np.zeros(2)
    for last in range(_ROUNDS):
        above, reached = _bounds(tcp, orientation, np.interp(cells.mean(axis=0), place, u), cells)
        sampled = np.maximum(sampled, reached.max(axis=1))
        wide = (above > (1 + _ABOVE) * sampled[:, None] + _SLACK).any(axis=0)
        if last == _ROUNDS - 1 or 4 * wide.sum() > _MOST:
            wide[:] = False
        largest = np.maximum(largest, above[:, ~wide].max(axis=1, initial=0.0))
        if not wide.any():
            break
        cells = cut(cells[:, wide], np.full(int(wide.sum()), 4))
    return Deviation(float(largest[0]), float(largest[1]), _corners(tcp, orientation, place, u))


def _bounds(tcp: TcpPath, orientation: Orientation, u: Array, cells: Array) -> tuple[Array, Array]:
    """Upper bounds of distance and angle in the cells, and values that are reached there, each (2,
    m)."""
    sides = Sides.of(orientation)
    origin = orientation.curve.origin[np.minimum(u.astype(int), orientation.curve.segments - 1)]
    near = np.stack(sides.around(np.searchsorted(sides.kept, origin)))
    found = np.empty((2, 2, len(u)))
    for begin in range(0, len(u), bernstein.AT_ONCE):
        part = slice(begin, begin + bernstein.AT_ONCE)
        position, axis = tcp.enclosed(cells[:, part])
        first, last = near[:, part]
        # once to see how near the polygon is, once for the axes stated at its nearest places
        most, nearest, reached = _distances(sides, position, axis, first, last)
        angle, held = _angles(sides, position, axis, (first, last), nearest)
        found[:, :, part] = (most, angle), (reached, held)
    return found[0], found[1]


def _shifts(first: Integers, last: Integers) -> Iterator[tuple[Integers, Integers]]:
    """Numbers of the cells, and a side of each: one side after the other of all that are near."""
    for shift in range(int((last - first).max()) + 1):
        cell = np.flatnonzero(first + shift <= last)
        yield cell, first[cell] + shift


def _distances(
    sides: Sides, position: Enclosed, axis: Enclosed, first: Integers, last: Integers
) -> tuple[Array, Array, Array]:
    """Upper bounds of the distance of the TCP, and of place and direction together, from the
    polygon, and a distance that is reached, each (m,)."""
    m = len(first)
    most = np.full(m, np.inf)
    nearest = np.full(m, np.inf)
    reached = np.full((2, m), np.inf)
    both = _both(position, axis)
    miss = _both_miss(position, axis)
    for cell, k in _shifts(first, last):
        P = position.points[cell]
        d = np.stack([to_segment(P[:, i], *sides.ends(k, 3))[0] for i in range(3)])
        most[cell] = np.minimum(most[cell], d.max(axis=0) + position.miss[cell])
        reached[:, cell] = np.minimum(reached[:, cell], d[::2])
        gap = [to_segment(both[cell, i], *sides.ends(k))[0] for i in range(3)]
        nearest[cell] = np.minimum(nearest[cell], np.max(gap, axis=0) + miss[cell])
    return most, nearest, reached.max(axis=0)


def _angles(
    sides: Sides,
    position: Enclosed,
    axis: Enclosed,
    near: tuple[Integers, Integers],
    nearest: Array,
) -> tuple[Array, Array]:
    """Upper bound of the angle between the tool axis and the one stated at the nearest place, over
    all sides that may be the nearest somewhere in the cell; and an angle that is reached."""
    both = _both(position, axis)
    miss = _both_miss(position, axis)
    middle = (both[:, 0] + 2 * both[:, 1] + both[:, 2]) / 4
    radius = bernstein.highest(norms(both - middle[:, None])) + miss
    angle = np.zeros(len(nearest))
    held = np.zeros(len(nearest))
    closest = np.full(len(nearest), np.inf)
    for cell, k in _shifts(*near):
        gap = to_segment(middle[cell], *sides.ends(k))[0]
        may = gap - radius[cell] <= nearest[cell]
        may &= ~_next_is_nearer(sides, both[cell], k, miss[cell])
        cell = cell[may]
        k = k[may]
        line, missed = _stated(sides, both[cell], k, miss[cell])
        found = _angle_to_line(axis.points[cell], axis.miss[cell], line, missed)
        angle[cell] = np.maximum(angle[cell], found)
        shown = _angle_at(sides, middle[cell], k)
        better = gap[may] < closest[cell]
        held[cell] = np.where(better, shown, held[cell])
        closest[cell] = np.minimum(gap[may], closest[cell])
    return angle, held


def _next_is_nearer(sides: Sides, both: Array, k: Integers, miss: Array) -> Mask:
    """Whether a corner of a side is nearer than all of it, and the next side nearer than that
    corner, all over the cells."""
    here = _foot(sides, both, k, miss)
    before = _foot(sides, both, np.maximum(k - 1, 1), miss)
    after = _foot(sides, both, np.minimum(k + 1, len(sides.corners) - 1), miss)
    start = (here[1] <= 0) & (before[1] <= 1) & (k > 1)
    end = (here[0] >= 1) & (after[0] >= 0) & (k < len(sides.corners) - 1)
    return np.asarray(start | end)


def _foot(sides: Sides, both: Array, k: Integers, miss: Array) -> tuple[Array, Array]:
    """Least and largest parameter of the foot on the straight line of a side, each (m,)."""
    start, end = sides.ends(k)
    length = norms(end - start)
    foot = inner_products(both - start[:, None], (end - start)[:, None]) / length[:, None] ** 2
    low, high = bernstein.hull(foot)
    return low - miss / length, high + miss / length


def _stated(sides: Sides, both: Array, k: Integers, miss: Array) -> tuple[Array, Array]:
    """Parabolas of the axis stated at the foot on a side (m, 3, 3), and what they may miss (m,)."""
    start, end = sides.ends(k)
    side = end - start
    length2 = inner_products(side, side)
    foot = inner_products(both - start[:, None], side[:, None]) / length2[:, None]
    inside = np.clip(foot, 0.0, 1.0)
    # partly beyond an end of the side, the foot stands still for a while
    beyond = (inside != foot).any(axis=1)
    low, high = bernstein.hull(inside)
    spread = np.where(beyond, high - low, 0.0) + miss / np.sqrt(length2)
    turn = side[:, 3:] / ROTATION_LENGTH
    line = start[:, None, 3:] / ROTATION_LENGTH + inside[..., None] * turn[:, None]
    return line, spread * norms(turn)


def _angle_at(sides: Sides, point: Array, k: Integers) -> Array:
    """Angle between the direction of points (m, 6) and the axis stated at their feet on a side."""
    start, end = sides.ends(k)
    t = to_segment(point, start, end)[1]
    line = (start + t[:, None] * (end - start))[:, 3:]
    sine = norms(np.cross(point[:, 3:], line))
    return np.asarray(np.arctan2(sine, inner_products(point[:, 3:], line)))


def _both(position: Enclosed, axis: Enclosed) -> Array:
    """Place and direction together: so that turning on the spot has places, too."""
    return np.concatenate([position.points, ROTATION_LENGTH * axis.points], axis=2)


def _both_miss(position: Enclosed, axis: Enclosed) -> Array:
    return position.miss + ROTATION_LENGTH * axis.miss


def _angle_to_line(A: Array, miss: Array, line: Array, missed: Array) -> Array:
    """Largest angle between a unit vector, near the parabola A, and a vector near the parabola
    `line`, whose coefficients lie on one straight line.

    |a x l| is the norm of a polynomial, at most that of its largest Bernstein coefficient.
    """
    quartic = bernstein.product(A, line, np.cross)
    longest = bernstein.highest(norms(line))
    far = norms(line - line[:, :1]).argmax(axis=1)
    rows = np.arange(len(line))
    other = norms(line - line[rows, far][:, None]).argmax(axis=1)
    origin = np.zeros_like(line[:, 0])
    shortest = to_segment(origin, line[rows, far], line[rows, other])[0] - missed
    shortest = np.maximum(shortest, 1e-12)
    size = bernstein.highest(norms(quartic))
    sine = (size + miss * longest + missed * (1 + miss)) / shortest
    products = inner_products(A[:, :, None], line[:, None]).reshape(-1, 9)
    along = bernstein.lowest(products) - miss * longest
    # both on the same side: the angle is that of the sine
    same = (along - missed * (1 + miss) > 0) & (sine < 1)
    return np.where(same, np.arcsin(np.minimum(sine, 1.0)), np.pi)


def _corners(tcp: TcpPath, orientation: Orientation, along: Array, u: Array) -> float:
    """Largest distance of a way-point from the motion: Newton's method from its place on the curve,
    all at once."""
    curve = orientation.curve
    joints = tcp.joints
    goal = curve.path.position
    kept = kept_points(curve)
    # a way-point that was left out repeats the one before
    place = np.searchsorted(kept, np.arange(len(goal)), side="right") - 1
    ends = np.searchsorted(curve.origin, kept, side="right").astype(float)
    s = np.interp(ends[place], u, along)
    best = np.full(len(goal), np.inf)
    gap = np.diff(joints.knots, prepend=joints.knots[0], append=joints.knots[-1])
    near = np.maximum(gap[:-1], gap[1:])[
        np.clip(np.searchsorted(joints.knots, s), 0, len(joints.knots) - 1)
    ]
    # a knot of the curve may be far from its way-point where the sides beside it differ in length
    apart = np.diff(s, prepend=s[0], append=s[-1])
    reach = np.maximum(np.maximum(near, curve.tolerance), np.maximum(apart[:-1], apart[1:]))
    for _ in range(8):
        away = goal - tcp.pose(s)[0]
        # any place on the motion bounds the distance from above
        best = np.minimum(best, np.linalg.norm(away, axis=1))
        rate = tcp.velocity(s, joints.piece(s))
        step = (away * rate).sum(axis=1) / np.maximum((rate**2).sum(axis=1), 1e-12)
        s = np.clip(s + np.clip(step, -reach, reach), joints.knots[0], joints.knots[-1])
    return float(best.max())


def singularity_margins(model: Model, followed: Followed) -> dict[str, float]:
    """Lower bounds of |sin q5| [-], |r| [m] and |k| [m] (eqs. 34-36) that hold at every point of
    the path."""
    factors = model.function("singularity_factors")
    value = compile_function(factors)
    radius = compile_function(disc_function(factors))
    joints = followed.joints.first(model.robot.n)
    coefficients, remainder = parabolas(
        joints,
        joints.knots,
        lambda q, dq, ddq: value.map(q),
        lambda q, dq, ddq, r, dr, ddr: radius.map(q, r),
    )
    lower = bernstein.least_size(coefficients[0]) - remainder[0]
    smallest = np.maximum(lower.min(axis=0), 0.0)
    return dict(zip(NAMES, map(float, smallest), strict=True))
