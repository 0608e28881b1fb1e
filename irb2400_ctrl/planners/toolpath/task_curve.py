"""`TaskCurve`: the smooth curve of the tool through a path's way-points, corners rounded within a
tolerance.

The way-points, as points (p, L axis) or (p, L columns of R) of one vector space with L in metres
per radian, are the control polygon of a uniform cubic B-spline. Such a curve is twice continuously
differentiable, exactly straight where its control points are, and passes the control point V_i at
the distance |V_{i-1} - 2 V_i + V_{i+1}| / 6. At corners, further control points on the polygon's
sides hold that distance below the tolerance. Where the polygon bends gently (a curve sampled by
CAM: by little, and no higher over its chords than `GENTLE` tolerances), and where it turns back
(the bottom of a hole: the motion all but stops there anyway), the control points are chosen so that
the curve passes through the way-points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, inner_products, norms
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

ROTATION_LENGTH = 0.1
"""how far the TCP travels for one radian of turning, when lengths along the path are compared
[m/rad]"""
SMOOTH_BEND = 0.3
"""change of direction up to which a way-point counts as part of a smooth curve, not a corner
[rad]"""
BACK = 2 * np.sin(np.radians(75))
"""change of direction from which a way-point counts as one where the way turns back: that of a turn
by 150 degrees"""
GENTLE = 10.0
"""how far beside its chords a smooth curve may swing through the way-points, in tolerances: sampled
curves do by less, a polygon of long sides bends as little but is none"""
TOLERANCE = 5e-5
"""how far corners are cut, unless asked otherwise [m]"""
FEED_STEP = 1e-3
"""distance of the control points beside a way-point at which the feed changes [m]"""
# rows: basis functions of a uniform cubic B-spline segment in powers of u
_BASIS = np.array([[1, -3, 3, -1], [4, 0, -6, 3], [1, 3, 3, -3], [0, 0, 0, 1]]) / 6.0
_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(5)
# stretches whose lengths are taken at once
_AT_ONCE = 1000


@dataclass(frozen=True)
class TaskCurve:
    """A cubic B-spline in m dimensions; segment k of the parameter is k <= u < k + 1."""

    control: Array
    """control points with a phantom at either end [m], shape (segments + 3, m)"""
    origin: npt.NDArray[np.int64]
    """number of the way-point that each segment leads to, shape (segments,)"""
    full: bool
    """the orientation is complete (not only the tool axis)"""
    path: ToolPath
    tolerance: float
    """bound of the corner rounding [m]"""

    @property
    def segments(self) -> int:
        """Number of polynomial pieces."""
        return len(self.control) - 3

    def __call__(self, u: Array, order: int = 0) -> Array:
        """Derivative of the curve of the order 0 or 1 by u, shape (n, m) [m]."""
        k = np.clip(np.floor(u).astype(int), 0, self.segments - 1)
        t = np.repeat(u - k, self.control.shape[1]).reshape(len(u), -1)
        powers = [power.take(k, axis=0) for power in self._powers[order:]]
        if order:
            powers = [i * power for i, power in enumerate(powers, start=1)]
        value = powers[-1]
        for power in powers[-2::-1]:
            value = value * t + power
        return np.asarray(value)

    @cached_property
    def _powers(self) -> Array:
        """Coefficients of the powers of u - k on every segment, shape (4, segments, m)."""
        beside = np.stack([self.control[i : i + self.segments] for i in range(4)])
        return np.tensordot(_BASIS.T, beside, axes=1)

    def lengths(self, u: Array) -> Array:
        """Length of the curve between neighbouring parameters u (sorted, none across a knot), shape
        (n - 1,) [m]."""
        half = np.diff(u) / 2
        found = np.empty_like(half)
        # the points of all of a long path at once would be the largest arrays of its plan
        for begin in range(0, len(half), _AT_ONCE):
            part = slice(begin, begin + _AT_ONCE)
            nodes = (u[:-1][part] + half[part])[:, None] + half[part, None] * _GAUSS
            speed = norms(self(np.clip(nodes, 0, self.segments).ravel(), 1)).reshape(nodes.shape)
            found[part] = inner_products(speed, _WEIGHT) * half[part]
        return found

    def pose(self, u: Array) -> tuple[Array, Array, Array | None]:
        """Position (n, 3) [m], tool axis (n, 3) towards the spindle or x axis, and rotation (n, 3,
        3) if stated."""
        point = self(u)
        first = point[:, 3:6]
        first = first / np.linalg.norm(first, axis=1, keepdims=True)
        if not self.full:
            return point[:, :3], first, None
        second = point[:, 6:9]
        second = second - (second * first).sum(1, keepdims=True) * first
        second /= np.linalg.norm(second, axis=1, keepdims=True)
        return point[:, :3], first, np.stack([first, second, np.cross(first, second)], axis=2)


def smooth_curve(path: ToolPath, tolerance: float = TOLERANCE) -> TaskCurve:
    """The curve of a path; `tolerance` bounds how far corners are cut [m].

    Raises:
        InputError: all points are the same, or the orientation turns by more than 170 deg between
        two points.
    """
    points, number = _points(path)
    feed = path.feed[number]
    changes = feed[1:-1] != feed[2:]
    corner_step, passed = _corner_steps(points, tolerance, changes)
    control, origin, passed = _with_neighbours(points, number, corner_step, passed)
    control = _through(control, passed)
    control = np.vstack([2 * control[0] - control[1], control, 2 * control[-1] - control[-2]])
    return TaskCurve(control, origin, path.rotation is not None, path, tolerance)


def turning_back(path: ToolPath) -> npt.NDArray[np.int64]:
    """Indices of the way-points at which the way turns back, as at the bottom of a hole: their
    curve comes no farther than there, and passes them exactly.

    Raises:
        InputError: as `smooth_curve`.
    """
    points, number = _points(path)
    return np.asarray(number[1:-1][_bends(points) > BACK])


def _points(path: ToolPath) -> tuple[Array, npt.NDArray[np.int64]]:
    """The way-points in the space of the curve, without repeated ones, and which each one is."""
    L = ROTATION_LENGTH
    if path.axis is not None:
        vectors = path.axis
    else:
        assert path.rotation is not None
        vectors = np.hstack([path.rotation[:, :, 0], path.rotation[:, :, 1]])
    points = np.hstack([path.position, L * vectors])
    # repeated points carry no direction; below a tenth of a micrometre they are the same
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    keep = np.concatenate([[True], step > 1e-7])
    if keep.sum() < 2:
        raise InputError(f"{path.name}: all points are the same, expected a path with a length")
    return _turned_in_steps(points[keep], np.flatnonzero(keep), path)


def _bends(points: Array) -> Array:
    """Change of direction at the inner points: twice the sine of half the turn, shape (n - 2,)."""
    sides = np.diff(points, axis=0)
    length = np.linalg.norm(sides, axis=1)
    return np.asarray(np.linalg.norm(np.diff(sides / length[:, None], axis=0), axis=1))


def _turned_in_steps(
    points: Array, number: npt.NDArray[np.int64], path: ToolPath
) -> tuple[Array, npt.NDArray[np.int64]]:
    """Intermediate points where the orientation turns by more than 10 degrees in one move (great
    circles)."""
    L = ROTATION_LENGTH
    vectors = points[:, 3:].reshape(len(points), -1, 3) / L
    cosine = np.clip((vectors[:-1] * vectors[1:]).sum(axis=2).min(axis=1), -1, 1)
    angle = np.arccos(cosine)
    if (angle > np.radians(170)).any():
        at = int(np.argmax(angle))
        raise InputError(
            f"{path.name}: the tool turns by {np.degrees(angle[at]):.0f} deg between points "
            f"{number[at] + 1} and "
            f"{number[at + 1] + 1}, so its way is ambiguous; add a point in between"
        )
    count = np.maximum(1, np.ceil(angle / np.radians(10)).astype(int))
    if (count == 1).all():
        return points, number
    from scipy.spatial.transform import Rotation, Slerp

    pieces = [points[:1]]
    numbers = [number[:1]]
    for i, steps in enumerate(count):
        if steps == 1:
            pieces.append(points[i + 1 : i + 2])
        else:
            t = np.arange(1, steps + 1)[:, None] / steps
            p = points[i, :3] + t * (points[i + 1, :3] - points[i, :3])
            if vectors.shape[1] == 1:
                a = vectors[i, 0]
                b = vectors[i + 1, 0]
                w = angle[i]
                turned = (np.sin((1 - t) * w) * a + np.sin(t * w) * b) / np.sin(w)
            else:
                frames = [
                    np.stack([v[0], v[1], np.cross(v[0], v[1])], axis=1) for v in vectors[i : i + 2]
                ]
                R = Slerp([0, 1], Rotation.from_matrix(np.array(frames)))(t.ravel()).as_matrix()
                turned = np.hstack([R[:, :, 0], R[:, :, 1]])
            pieces.append(np.hstack([p, L * turned]))
        numbers.append(np.full(steps, number[i + 1]))
    return np.vstack(pieces), np.concatenate(numbers)


def _corner_steps(
    points: Array, tolerance: float, changes: npt.NDArray[np.bool_]
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Distance of the control points to add on either side of each point (inf: none) [m], and which
    points the curve passes through.

    With neighbours at the distance d along both sides the curve passes the corner at d |t2 - t1| /
    6. Where the feed changes (`changes`, inner points) the segments must meet at the way-point;
    without neighbours they meet a sixth of the difference of its sides beside it. Where the way
    turns back, neighbours at one distance make the way-point the farthest that the curve comes.
    """
    sides = np.diff(points, axis=0)
    length = np.linalg.norm(sides, axis=1)
    bend = _bends(points)
    before = length[:-1]
    after = length[1:]
    longer = np.maximum(before, after)
    # height of an arc of that bend over its chord, the tool's turning left out
    height = np.linalg.norm(np.diff(sides[:, :3] / length[:, None], axis=0), axis=1) * longer / 8
    smooth = (bend < SMOOTH_BEND) & (longer < 2 * np.minimum(before, after))
    smooth &= height <= GENTLE * tolerance
    # the longer side decides: beside a tiny one the curve would still cut the corner from far away
    passed = bend * longer / 6
    needed = np.where(
        ~smooth & (passed > tolerance), 6 * tolerance / np.maximum(bend, 1e-12), np.inf
    )
    aside = ~smooth & changes & (np.abs(after - before) / 6 > tolerance)
    near = np.minimum(0.45 * np.minimum(before, after), FEED_STEP)
    needed = np.where(aside, np.minimum(needed, near), needed)
    back = bend > BACK
    even = np.minimum(6 * tolerance / np.maximum(bend, 1e-12), 0.45 * np.minimum(before, after))
    needed = np.where(back, even, needed)
    through = smooth | back
    return np.pad(needed, 1, constant_values=np.inf), np.pad(through, 1, constant_values=False)


def _with_neighbours(
    points: Array, number: npt.NDArray[np.int64], step: Array, passed: npt.NDArray[np.bool_]
) -> tuple[Array, npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
    """Control points: the way-points and, next to each corner, more on its sides; which of them the
    curve passes."""
    control = [points[0]]
    origin = []
    through = [False]
    for i in range(len(points) - 1):
        side = points[i + 1] - points[i]
        length = float(np.linalg.norm(side))
        fractions = []
        for d, at_end in ((step[i], False), (step[i + 1], True)):
            if np.isfinite(d):
                # never past the middle of the side, so that the neighbours of two corners keep
                # their order
                part = min(d / length, 0.45)
                fractions += [1 - part if at_end else part]
                # a second one further out, so that the long side is straight right up to the corner
                if 2 * part < 0.45:
                    fractions += [1 - 2 * part if at_end else 2 * part]
        control += [points[i] + f * side for f in sorted(fractions)] + [points[i + 1]]
        origin += [number[i + 1]] * (len(fractions) + 1)
        through += [False] * len(fractions) + [bool(passed[i + 1])]
    return np.array(control), np.array(origin), np.array(through)


def _through(points: Array, passed: npt.NDArray[np.bool_]) -> Array:
    """Control points V with (V_{i-1} + 4 V_i + V_{i+1}) / 6 = P_i at points that are passed and
    V_i = P_i elsewhere."""
    if not passed.any():
        return points
    from scipy.linalg import solve_banded

    side = np.where(passed, 1 / 6, 0.0)
    bands = np.array([np.roll(side, 1), np.where(passed, 4 / 6, 1.0), np.roll(side, -1)])
    solution: Array = solve_banded((1, 1), bands, points)
    return solution
