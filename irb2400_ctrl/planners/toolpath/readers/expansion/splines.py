"""B-splines as points whose chords keep within a tolerance of the curve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError

CUBIC = 3
ROUNDS = 20


def clamped_cubic(inner: Array, control: Array) -> tuple[Array, Array]:
    """Knot vector and control points of a cubic that starts and ends in its outer control points.

    Args:
        inner: knots after the leading ones, up to and with one at the end, rising, shape (k,).
        control: control points, the first being where the tool is, shape (k + 3, m).

    Raises:
        InputError: the numbers of knots and control points do not fit, or the knots do not rise.
    """
    wanted = len(control) - CUBIC
    if len(control) < CUBIC + 1 or len(inner) != wanted:
        raise InputError(
            f"found {len(inner)} knots and {len(control) - 1} control points, expected "
            "two control points more than knots (cubic)"
        )
    knots = np.concatenate([np.zeros(CUBIC + 1), inner, np.full(CUBIC, inner[-1])])
    if (np.diff(knots) < 0).any() or inner[-1] <= 0:
        raise InputError(f"the knots do not rise from zero; found {inner[:5]} …")
    return knots, control


def points(knots: Array, control: Array, chord: float) -> Array:
    """Points after the first control point along a cubic, shape (k, m); the first three columns
    are places [m].

    Halved until the middles of all pieces, and their quarters, are within `chord` of the chord.

    Args:
        knots: not falling, shape (k + 4,).
        control: control points, shape (k, m).
        chord: [m].
    """
    from scipy.interpolate import BSpline

    return _halved(BSpline(knots, control, CUBIC), np.unique(knots), chord)[1:]


def rational_points(knots: Array, control: Array, degree: int, chord: float) -> Array:
    """As `points`, the first one too, of a rational B-spline: control points and weights.

    Args:
        knots: not falling, shape (k + degree + 1,).
        control: places [m], then their weight [-], shape (k, 4).
        degree: of the spline.
        chord: [m].
    """
    from scipy.interpolate import BSpline

    weights = control[:, 3:]
    curve = BSpline(knots, np.hstack([control[:, :3] * weights, weights]), degree)

    def place(t: Array) -> Array:
        found = curve(t)
        return np.asarray(found[:, :3] / found[:, 3:], dtype=float)

    inner = knots[degree : len(knots) - degree]
    return _halved(place, np.unique(inner), chord)


def _halved(curve: Callable[[Array], Array], t: Array, chord: float) -> Array:
    """Points at t, halved until every chord is near enough."""
    for _ in range(ROUNDS):
        p = curve(t)[:, :3]
        far = np.zeros(len(t) - 1)
        for share in (0.25, 0.5, 0.75):
            on_curve = curve(t[:-1] + share * np.diff(t))[:, :3]
            far = np.maximum(far, _distance(on_curve, p[:-1], p[1:]))
        coarse = far > chord
        if not coarse.any():
            break
        t = np.sort(np.concatenate([t, (t[:-1] + t[1:])[coarse] / 2]))
    return np.asarray(curve(t), dtype=float)


def _distance(points: Array, start: Array, end: Array) -> Array:
    """Distance of points from the segments start … end, shape (n,)."""
    side = end - start
    square = np.maximum((side**2).sum(axis=1), 1e-30)
    t = np.clip(((points - start) * side).sum(axis=1) / square, 0, 1)
    return np.asarray(np.linalg.norm(points - start - t[:, None] * side, axis=1))
