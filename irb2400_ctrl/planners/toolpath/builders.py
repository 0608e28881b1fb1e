"""Tool paths in Python: lines, circles, splines, way-points and rasters; lengths in metres, angles
in radians.

Curves are sampled so finely that the polygon through the samples stays within `chord` of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import finite, numbers
from irb2400_ctrl.planners.toolpath.orientation import frame_of
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.typed import typed

UP = (0.0, 0.0, 1.0)
CHORD = 1e-5
MOST_SWEEP = 8 * np.pi
"""of an arc [rad]: more is taken for degrees"""


@typed
def way_points(
    points: ArrayLike,
    axis: ArrayLike = UP,
    *,
    feed: ArrayLike = np.inf,
    name: str = "way-points",
) -> ToolPath:
    """Straight lines through points (n, 3) [m]; `axis` one tool axis or one per point; `feed` [m/s]
    likewise.

    Args:
        points: [m], shape (n, 3).
        axis: towards the spindle, shape (3,) or (n, 3).
        feed: [m/s], one number or shape (n,).
        name: of the path.
    """
    position = np.asarray(points, dtype=float)
    if position.ndim != 2 or position.shape[1] != 3:
        raise InputError(f"{name}: points have shape {position.shape}, expected (n, 3)")
    n = len(position)
    axes = _each(f"{name}: axis", axis, (3,), n)
    return ToolPath(position, axes, None, _each(f"{name}: feed", feed, (), n), name)


@typed
def poses(X_BT: ArrayLike, *, feed: ArrayLike = np.inf, name: str = "poses") -> ToolPath:
    """Straight lines through full poses (n, 4, 4).

    Args:
        X_BT: of the tool in the base [m], shape (n, 4, 4).
        feed: [m/s], one number or shape (n,).
        name: of the path.
    """
    X = np.asarray(X_BT, dtype=float)
    if X.ndim != 3 or X.shape[1:] != (4, 4):
        raise InputError(f"{name}: poses have shape {X.shape}, expected (n, 4, 4)")
    return ToolPath(
        X[:, :3, 3],
        None,
        X[:, :3, :3],
        _each(f"{name}: feed", feed, (), len(X)),
        name,
    )


@typed
def line(
    start: Sequence[float], end: Sequence[float], axis: ArrayLike = UP, *, feed: float = np.inf
) -> ToolPath:
    """A straight line; `axis` may be one tool axis or one for each end.

    Args:
        start: [m], shape (3,).
        end: [m], shape (3,).
        axis: towards the spindle, shape (3,) or (2, 3).
        feed: [m/s].
    """
    return way_points([start, end], axis, feed=feed, name="line")


@typed
def circle(
    centre: Sequence[float],
    radius: float,
    *,
    normal: Sequence[float] = UP,
    axis: ArrayLike | None = None,
    start: float = 0.0,
    sweep: float = 2 * np.pi,
    feed: float = np.inf,
    chord: float = CHORD,
) -> ToolPath:
    """An arc about `centre` in the plane across `normal`, from angle `start` over `sweep`; tool
    axis `normal`.

    Args:
        centre: [m], shape (3,).
        radius: [m].
        normal: of its plane, shape (3,).
        axis: towards the spindle, shape (3,); default the normal.
        start: angle of the first point [rad].
        sweep: angle that it goes on for [rad].
        feed: [m/s].
        chord: largest distance of arc and polygon [m].
    """
    if radius <= 0 or chord <= 0 or not 0 < abs(sweep) <= MOST_SWEEP:
        raise InputError(
            f"circle: radius {radius}, chord {chord}, sweep {sweep}; expected positive lengths and "
            "a sweep in radians (2 pi is a whole turn), four turns at most"
        )
    z = finite("circle: normal", normal, (3,), "-")
    if not z.any():
        raise InputError("circle: normal has no direction, expected one such as (0, 0, 1)")
    z /= np.linalg.norm(z)
    x, y, _ = frame_of(z).T
    step = 2 * np.arccos(max(1 - chord / radius, 0.0))
    count = max(int(np.ceil(abs(sweep) / step)), 16)
    angle = start + sweep * np.arange(count + 1) / count
    middle = finite("circle: centre", centre, (3,), "m")
    points = middle + radius * (np.cos(angle)[:, None] * x + np.sin(angle)[:, None] * y)
    return way_points(points, z if axis is None else axis, feed=feed, name="circle")


@typed
def curve(
    position: Callable[[Array], Array],
    axis: Callable[[Array], Array] | Sequence[float] = UP,
    *,
    feed: float = np.inf,
    chord: float = CHORD,
    name: str = "curve",
) -> ToolPath:
    """A curve position(t) (k, 3) [m], 0 <= t <= 1, and tool axis axis(t) (k, 3) or a constant
    one.

    Args:
        position: from t (k,) to points [m], shape (k, 3).
        axis: from t (k,) to directions towards the spindle, shape (k, 3), or one of them.
        feed: [m/s].
        chord: largest distance of curve and polygon [m].
        name: of the path.
    """
    t = np.linspace(0, 1, 65)
    for _ in range(16):
        p = numbers(f"{name}, position(t)", position(t))
        if p.shape != (len(t), 3):
            raise InputError(
                f"{name}: position(t) has shape {p.shape} for t of shape {t.shape}, expected "
                f"{(len(t), 3)}: a point for each"
            )
        middle = (t[:-1] + t[1:]) / 2
        sagitta = np.linalg.norm(position(middle) - (p[:-1] + p[1:]) / 2, axis=1)
        coarse = sagitta > chord
        if not coarse.any():
            axes = axis(t) if callable(axis) else axis
            return way_points(p, axes, feed=feed, name=name)
        t = np.sort(np.concatenate([t, middle[coarse]]))
    raise InputError(
        f"{name}: the curve is not smooth enough for a chord tolerance of {1e3 * chord} mm"
    )


@typed
def spline(
    points: ArrayLike, axis: ArrayLike = UP, *, feed: float = np.inf, chord: float = CHORD
) -> ToolPath:
    """The cubic spline through points (n, 3) [m], over their chord length; tool axes are
    interpolated likewise.

    Args:
        points: [m], shape (n, 3).
        axis: towards the spindle, shape (3,) or (n, 3).
        feed: [m/s].
        chord: largest distance of spline and polygon [m].
    """
    from scipy.interpolate import CubicSpline

    p = np.asarray(points, dtype=float)
    if p.ndim != 2 or p.shape[1] != 3 or len(p) < 3:
        raise InputError(f"spline: points have shape {p.shape}, expected (n, 3) with n >= 3")
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    if (np.diff(s) <= 0).any():
        raise InputError(
            f"spline: point {int(np.argmax(np.diff(s) <= 0)) + 2} repeats the one before"
        )
    s /= s[-1]
    axes = _each("spline: axis", axis, (3,), len(p))
    position = CubicSpline(s, p)
    direction = CubicSpline(s, axes)
    return curve(
        lambda t: np.asarray(position(t)),
        lambda t: np.asarray(direction(t)),
        feed=feed,
        chord=chord,
        name="spline",
    )


@typed
def raster(
    centre: Sequence[float],
    length: float,
    width: float,
    *,
    lines: int,
    points: int,
    height: Callable[[Array, Array], Array] | None = None,
    feed: float = np.inf,
) -> ToolPath:
    """Parallel lines back and forth over a surface z = height(x, y) about `centre`; tool axis
    up.

    Args:
        centre: [m], shape (3,).
        length: of a line [m].
        width: over all lines [m].
        lines: number of them.
        points: on each.
        height: from x and y about the centre [m] to z above it [m]; default a plane.
        feed: [m/s].
    """
    if lines < 1 or points < 2:
        raise InputError(
            f"raster: {lines} lines of {points} points; expected at least 1 line of 2 points"
        )
    x_line = np.linspace(-length / 2, length / 2, points)
    passes = []
    for number, y in enumerate(np.linspace(-width / 2, width / 2, lines)):
        x = x_line if number % 2 == 0 else x_line[::-1]
        z = 0.0 if height is None else height(x, np.full(points, y))
        lift = _each("raster: height(x, y)", z, (), points)
        passes.append(np.stack([x, np.full(points, y), lift], axis=1))
    middle = finite("raster: centre", centre, (3,), "m")
    return way_points(np.vstack(passes) + middle, feed=feed, name="raster")


def _each(what: str, value: ArrayLike, one: tuple[int, ...], n: int) -> Array:
    """One value for all of n points, or one for each, shape (n, *one).

    Raises:
        InputError: another shape, or no numbers.
    """
    array = numbers(what, value)
    if array.shape not in {one, (n, *one)}:
        expected = f"{one or 'one number'} or {(n, *one)}"
        raise InputError(f"{what} has shape {array.shape}, expected {expected}")
    return np.broadcast_to(array, (n, *one))
