"""How far the tool is from where it should be."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import CompiledFunction, compile_function
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

BLOCK = 16
"""segments that are ruled out together"""


def tcp_positions(robot: Robot, q: Array) -> Array:
    """TCP positions in the base frame [m], shape (m, 3), of angles (m, n)."""
    poses = _tcp_pose(robot).map(q)[0]
    return np.ascontiguousarray(poses[:, :3, 3])


def _tcp_pose(robot: Robot) -> CompiledFunction:
    """The compiled pose, kept by geometry: arms that differ in mass or friction share it."""
    tool = None if robot.tool is None else robot.tool.tcp
    key = (tuple(link.frame for link in robot.links), robot.coupling, robot.flange, tool)
    if key not in _COMPILED:
        _COMPILED[key] = compile_function(Model(robot).function("tcp_pose"))
    return _COMPILED[key]


_COMPILED: dict[object, CompiledFunction] = {}


def contour_errors(path: Array, points: Array, window: int) -> Array:
    """Distance of each point from the path it belongs to [m], shape (m,).

    Being late on the path costs nothing here: a point is compared with the stretch of `path` (m, 3)
    that lies within `window` samples of it.

    Args:
        path: [m], shape (m, 3).
        points: [m], shape (m, 3).
        window: samples to either side.
    """
    best = np.linalg.norm(points - path, axis=1)
    start = path[:-1]
    along = np.diff(path, axis=0)
    length2 = np.maximum(np.einsum("ij,ij->i", along, along), 1e-30)
    arc = np.concatenate([[0.0], np.cumsum(np.sqrt(length2))])
    rows = np.arange(len(path))
    segments = len(start)
    for block in range(-window, window, BLOCK):
        shifts = range(block, min(block + BLOCK, window))
        first = np.clip(rows + shifts[0], 0, segments - 1)
        last = np.clip(rows + shifts[-1], 0, segments - 1)
        # a stretch that begins farther away than its length and the best so far cannot be nearer
        away = points - start[first]
        reach = best + arc[last + 1] - arc[first]
        near = np.flatnonzero(np.einsum("ij,ij->i", away, away) < reach * reach)
        k = near[:, None] + np.array(shifts)
        inside = (k >= 0) & (k < segments)
        k = np.clip(k, 0, segments - 1)
        offset = points[near, None] - start[k]
        share = np.clip(np.einsum("ijk,ijk->ij", offset, along[k]) / length2[k], 0.0, 1.0)
        distance = np.linalg.norm(offset - share[..., None] * along[k], axis=2)
        best[near] = np.minimum(best[near], np.where(inside, distance, np.inf).min(axis=1))
    return np.asarray(best)
