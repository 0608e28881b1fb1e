"""How far the tool is from where it should be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

Array = NDArray[np.float64]


def tcp_positions(robot: Robot, q: Array) -> Array:
    """TCP positions in the base frame [m], shape (m, 3), of angles (m, n)."""
    poses = compile_function(Model(robot).function("tcp_pose")).map(q)[0]
    return np.ascontiguousarray(poses[:, :3, 3])


def contour_errors(path: Array, points: Array, window: int) -> Array:
    """Distance of each point from the path it belongs to [m], shape (m,).

    Being late on the path costs nothing here: a point is compared with the stretch of `path` (m, 3) that lies within
    `window` samples of it.
    """
    count = len(path)
    best = np.linalg.norm(points - path, axis=1)
    start, along = path[:-1], np.diff(path, axis=0)
    length2 = np.maximum(np.einsum("ij,ij->i", along, along), 1e-30)
    rows = np.arange(count)
    for shift in range(-window, window):
        k = rows + shift
        valid = (k >= 0) & (k < count - 1)
        k = k[valid]
        offset = points[valid] - start[k]
        share = np.clip(np.einsum("ij,ij->i", offset, along[k]) / length2[k], 0.0, 1.0)
        distance = np.linalg.norm(offset - share[:, None] * along[k], axis=1)
        best[valid] = np.minimum(best[valid], distance)
    return np.asarray(best)
