"""Arcs and helices as points: exact on the circle, chords within a tolerance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError

SAME_PLACE = 1e-6
# what sums, inches and turned coordinates leave of equal places; no file states so short an arc
CALCULATED = 1e-10
# the turn that LinuxCNC takes for none, and GRBL at half as much: the last digit of the end [rad]
NO_TURN = 1e-6
# CAM writes three or four digits; both ends lie that far from the circle
EXPECTED_MISS = 1e-5
LARGEST_MISS = 5e-5
LARGEST_RELATIVE_MISS = 5e-3


@dataclass(frozen=True)
class Arc:
    """A circular or helical motion about an axis through `centre`, turning right-handed about
    `normal`."""

    centre: Array
    """[m], shape (3,)"""
    normal: Array
    """shape (3,)"""
    radius: float | None = None
    """as stated, to be checked [m]"""
    turns: int = 1
    """in which turn the end is reached: 1 within the first"""
    closes: float = CALCULATED
    """an end that lies no further along the circle from the start is the start [m]"""


def miss(arc: Arc, start: Array, end: Array) -> float:
    """How far the ends of the motion are off one circle about the axis [m].

    Args:
        arc: its centre and normal.
        start: [m], shape (3,).
        end: [m], shape (3,).
    """
    a, _ = _split(arc, start)
    b, _ = _split(arc, end)
    radii = [float(np.linalg.norm(a)), float(np.linalg.norm(b))]
    if arc.radius is not None:
        radii.append(arc.radius)
    return max(radii) - min(radii)


def checked_miss(arc: Arc, start: Array, end: Array) -> float:
    """The miss [m]; InputError where rounding does not explain it.

    Args:
        arc: its centre and normal.
        start: [m], shape (3,).
        end: [m], shape (3,).
    """
    if not np.linalg.norm(arc.normal) > 1e-9:
        raise InputError("the arc's axis has no direction")
    off = miss(arc, start, end)
    allowed = largest_miss(arc, start)
    if off > allowed:
        raise InputError(
            f"start and end are not on one circle: the radii differ by {1e3 * off:.4g} "
            f"mm, expected at most {1e3 * allowed:.3g}; check the centre (G-code: I J K from the "
            "start, or absolute with G90.1)"
        )
    if not np.linalg.norm(_split(arc, start)[0]) > SAME_PLACE:
        raise InputError("the arc begins in its own centre")
    return off


def blended_axes(start: Array, end: Array | None, k: int) -> Array:
    """Tool axes from `start` to `end` over k points, shape (k, 3).

    Args:
        start: unit vector, shape (3,).
        end: unit vector, shape (3,); None: as the start.
        k: number of points.
    """
    if end is None or np.allclose(end, start, atol=1e-9):
        return np.tile(start, (k, 1))
    t = (np.arange(1, k + 1) / k)[:, None]
    axes = (1 - t) * start + t * end
    length = np.linalg.norm(axes, axis=1, keepdims=True)
    if (length < 1e-6).any():
        raise InputError("the tool axis turns over within one arc")
    return np.asarray(axes / length)


def largest_miss(arc: Arc, start: Array) -> float:
    """The largest miss that rounding explains [m]."""
    radius = float(np.linalg.norm(_split(arc, start)[0]))
    return max(LARGEST_MISS, LARGEST_RELATIVE_MISS * radius)


def sweep(arc: Arc, start: Array, end: Array) -> float:
    """Angle from start to end about the normal, a full turn where the end is the start, and the
    whole turns before [rad].

    Args:
        arc: its axis and turns.
        start: [m], shape (3,).
        end: [m], shape (3,).
    """
    a, _ = _split(arc, start)
    b, _ = _split(arc, end)
    n = arc.normal / np.linalg.norm(arc.normal)
    angle = math.atan2(float(n @ np.cross(a, b)), float(a @ b))
    closes = max(arc.closes, NO_TURN * float(np.linalg.norm(a)))
    closed = abs(angle) * float(np.linalg.norm(a)) <= closes
    angle = 2 * math.pi if closed else angle % (2 * math.pi)
    return angle + 2 * math.pi * (arc.turns - 1)


def count(arc: Arc, start: Array, end: Array, chord: float) -> int:
    """How many chords keep within `chord` [m] of the arc.

    Args:
        arc: its centre and normal.
        start: [m], shape (3,).
        end: [m], shape (3,).
        chord: largest distance of chord and arc [m].
    """
    radius = max(float(np.linalg.norm(_split(arc, p)[0])) for p in (start, end))
    if radius <= chord:
        return 8
    step = min(2 * math.acos(1 - chord / radius), math.pi / 4)
    return max(math.ceil(sweep(arc, start, end) / step - 1e-9), 1)


def points(arc: Arc, start: Array, end: Array, chord: float) -> Array:
    """Points after `start` up to `end`, shape (k, 3).

    The radius and the height go linearly from those of the start to those of the end, so that both
    ends are met although they are rounded.

    Args:
        arc: its centre and normal.
        start: [m], shape (3,).
        end: [m], shape (3,).
        chord: largest distance of chord and arc [m].
    """
    n = arc.normal / np.linalg.norm(arc.normal)
    a, low = _split(arc, start)
    b, high = _split(arc, end)
    k = count(arc, start, end, chord)
    t = np.arange(1, k + 1) / k
    angle = sweep(arc, start, end) * t
    r0 = float(np.linalg.norm(a))
    r1 = float(np.linalg.norm(b))
    u = a / r0
    v = np.cross(n, u)
    radius = r0 + (r1 - r0) * t
    flat = radius[:, None] * (np.cos(angle)[:, None] * u + np.sin(angle)[:, None] * v)
    result = arc.centre + flat + (low + (high - low) * t)[:, None] * n
    result[-1] = end
    return np.asarray(result)


def _split(arc: Arc, point: Array) -> tuple[Array, float]:
    """The part of point − centre across the normal, and its height along it."""
    n = arc.normal / np.linalg.norm(arc.normal)
    d = point - arc.centre
    height = float(d @ n)
    return d - height * n, height
