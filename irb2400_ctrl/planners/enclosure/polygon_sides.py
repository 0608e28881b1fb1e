"""`Sides`: the sides of the polygon of way-points, as places and directions together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, inner_products, norms
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import ROTATION_LENGTH, TaskCurve

# sides within this length along the polygon of the side that a place belongs to, in corner
# tolerances, and the next ones, may be the nearest
_NEAR = 4.0


@dataclass(frozen=True)
class Sides:
    """Side k leads from corner k - 1 to corner k."""

    kept: Integers
    """numbers of the way-points that are corners: repeated ones are left out, shape (c,)"""
    corners: Array
    """position and ROTATION_LENGTH times the stated axis [m], shape (c, 6)"""
    reach: float
    """[m]"""

    @classmethod
    def of(cls, orientation: Orientation) -> Sides:
        """Of the placed path."""
        curve = orientation.curve
        kept = kept_points(curve)
        stated = curve.path.tool_axis(orientation.spindle)[kept]
        corners = np.hstack([curve.path.position[kept], ROTATION_LENGTH * stated])
        return cls(kept, corners, _NEAR * curve.tolerance)

    def ends(self, k: Integers, dimensions: int = 6) -> tuple[Array, Array]:
        """Start and end of the sides k, each (m, dimensions)."""
        first, last = (self.corners.take(number, axis=0) for number in (k - 1, k))
        return first[:, :dimensions], last[:, :dimensions]

    def around(self, k: Integers) -> tuple[Integers, Integers]:
        """The first and the last side that may be the nearest to places on the sides k."""
        last = len(self.corners) - 1
        k = np.clip(k, 1, last)
        length = np.linalg.norm(np.diff(self.corners, axis=0), axis=1)
        way = np.concatenate([[0.0], np.cumsum(length)])
        begin = np.searchsorted(way, way[k - 1] - self.reach, side="right")
        end = np.searchsorted(way, way[k] + self.reach, side="left")
        return np.clip(np.minimum(begin, k - 1), 1, last), np.clip(np.maximum(end, k + 1), 1, last)


def kept_points(curve: TaskCurve) -> Integers:
    """Numbers of the way-points that the curve was made from: repeated ones are left out."""
    return np.unique(np.concatenate([[0], curve.origin]))


def to_segment(p: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """Distance of points from segments and the foot's parameter 0…1."""
    side = b - a
    out = p - a
    t = np.clip(inner_products(out, side) / np.maximum(inner_products(side, side), 1e-30), 0, 1)
    return norms(out - t[:, None] * side), t
