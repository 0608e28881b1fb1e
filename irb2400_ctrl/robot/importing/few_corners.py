"""A convex body of few corners around points: what a mesh takes up, in a robot file's few lines."""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from irb2400_ctrl.arrays import Array

CORNERS = 40
"""a hull with no more is taken as it is"""
_FACES = 36
"""of a simpler body around it, at most"""
_CLOSE = 1e-3
"""such a body stands out by no more, unless it would need more faces [m]"""
_SAME = 4
"""digits of normals of the same face"""
_MOST = 2000
"""faces to choose from; of more, those of nearly one direction are one"""
_AT_ONCE = 50
"""faces that are laid against all points in one go"""
_DIGIT = 1e-4
"""of a written corner [m]"""


def few_corners(points: Array) -> Array:
    """Corners (k, 3) [m], with digits of 0.1 mm, whose hull contains points (m, 3).

    Faces of the points' hull, pushed out by a digit, are taken one by one where the body so far
    stands out most. Rounding moves a corner by less than that digit: what is left is around the
    points.
    """
    hull = _hull(points)
    points = hull.points[hull.vertices]
    # triangles of one flat side are one face
    for digits in range(_SAME, 0, -1):
        normals = np.unique(hull.equations[:, :3].round(digits), axis=0)
        if len(normals) <= _MOST:
            break
    faces = _around(normals / np.linalg.norm(normals, axis=1)[:, None], points)
    middle = points.mean(axis=0)
    axes = np.linalg.svd(points - middle, full_matrices=False)[2]
    box = np.concatenate([axes, -axes])
    every = faces if len(points) <= CORNERS else _around(box, points)
    corners = _corners(every, middle)
    while len(every) < _FACES:
        beyond = corners @ faces[:, :3].T + faces[:, 3]
        corner, face = np.unravel_index(int(beyond.argmax()), beyond.shape)
        if beyond[corner, face] < _CLOSE:
            break
        every = np.concatenate([every, faces[face : face + 1]])
        corners = _corners(every, middle)
    return corners


def _around(normals: Array, points: Array) -> Array:
    """Faces with these normals (m, 3) that touch the points: (m, 4)."""
    parts = np.array_split(normals, 1 + len(normals) // _AT_ONCE)
    farthest = [(points @ part.T).max(axis=0) for part in parts]
    return np.column_stack([normals, -np.concatenate(farthest)])


def _corners(faces: Array, middle: Array) -> Array:
    pushed = faces - np.array([0.0, 0.0, 0.0, _DIGIT])
    found = HalfspaceIntersection(pushed, middle).intersections
    return np.unique(np.round(found / _DIGIT) * _DIGIT, axis=0)


def _hull(points: Array) -> ConvexHull:
    try:
        return ConvexHull(points)
    except QhullError:
        # flat: half a digit thick
        shifts = 0.5 * _DIGIT * np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
        return ConvexHull((points[:, None] + shifts).reshape(-1, 3))
