"""The smallest capsule around points that a short search finds.

Direction and middle are searched for; radius and ends follow from all points, so that it is around
them whatever the search found. Deterministic.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array

_DIRECTIONS = 48
"""looked at on the half sphere, before the best is turned a little"""
_EXTREME = 96
"""points that the search looks at"""
_STEPS = 40
"""towards the middle of a circle around points"""
_WIDER = (1.0, 1.03, 1.08, 1.15, 1.3)
"""a little more radius may spare much length"""


def capsule_around(points: Array) -> tuple[Array, float]:
    """Both ends (2, 3) and the radius of a capsule around points (k, 3) [m]."""
    _, _, main = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    some = _extreme(points)
    tried = np.concatenate([main, half_sphere(_DIRECTIONS)])
    best = tried[int(np.argmin(_volumes(some, tried)))]
    for angle in (0.15, 0.06, 0.02):
        turned = np.cos(angle) * best + np.sin(angle) * _across(best, 12)
        tried = np.concatenate([best[None], turned])
        best = tried[int(np.argmin(_volumes(some, tried)))]
    radius, low, high, middle, plane = _enclosed(points, best[None])
    wider = int(_size(radius, low, high)[0].argmin())
    span = np.array([low[0, wider], high[0, wider]])
    if span[0] > span[1]:
        span[:] = span.mean()
    ends = plane[0] @ middle[0] + span[:, None] * best
    return ends, float(radius[0, wider])


def half_sphere(count: int) -> Array:
    """Directions spread evenly over a half sphere (a Fibonacci spiral), shape (count, 3)."""
    z = (np.arange(count) + 0.5) / count
    turn = np.pi * (1 + 5**0.5) * np.arange(count)
    r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1)


def _volumes(points: Array, directions: Array) -> Array:
    radius, low, high, _, _ = _enclosed(points, directions)
    return np.asarray(_size(radius, low, high).min(axis=1))


def _size(radius: Array, low: Array, high: Array) -> Array:
    length = np.maximum(high - low, 0.0)
    return np.asarray(np.pi * radius**2 * (length + 4 / 3 * radius))


def _enclosed(points: Array, directions: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Capsules along each direction around all points.

    Returns:
        radius, low end, high end along the direction, each (m, radii); the middle of the circle (m,
        2) in the plane across, and the two directions that span the plane (m, 3, 2). Where the low
        end is above the high one, a ball between them is enough.
    """
    plane = _planes(directions)
    across = np.einsum("kj,mji->mki", points, plane)
    along = points @ directions.T
    # a circle around points: step after step towards the farthest (Badoiu and Clarkson, 2003)
    middle = (across.min(axis=1) + across.max(axis=1)) / 2
    rows = np.arange(len(directions))
    for step in range(2, _STEPS):
        far = ((across - middle[:, None]) ** 2).sum(axis=2).argmax(axis=1)
        middle = middle + (across[rows, far] - middle) / (step + 1) ** 1.2
    off = np.sqrt(((across - middle[:, None]) ** 2).sum(axis=2))
    radius = off.max(axis=1)[:, None] * np.array(_WIDER)
    rise = np.sqrt(np.maximum(radius[:, :, None] ** 2 - off[:, None] ** 2, 0.0))
    height = along.T[:, None]
    return radius, (height + rise).min(axis=2), (height - rise).max(axis=2), middle, plane


def _extreme(points: Array) -> Array:
    """Corners that are farthest in some direction."""
    if len(points) <= _EXTREME:
        return points
    height = points @ half_sphere(_EXTREME // 2).T
    far = np.unique(np.concatenate([height.argmax(axis=0), height.argmin(axis=0)]))
    return np.asarray(points[far])


def _planes(directions: Array) -> Array:
    """Two directions across each of (m, 3), at right angles to each other, shape (m, 3, 2)."""
    helper = np.eye(3)[np.abs(directions).argmin(axis=1)]
    x = np.cross(helper, directions)
    x /= np.linalg.norm(x, axis=1)[:, None]
    return np.stack([x, np.cross(directions, x)], axis=2)


def _across(direction: Array, count: int) -> Array:
    """Directions across one, evenly all around, shape (count, 3)."""
    plane = _planes(direction[None])[0]
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.asarray(np.stack([np.cos(turns), np.sin(turns)], axis=1) @ plane.T)
