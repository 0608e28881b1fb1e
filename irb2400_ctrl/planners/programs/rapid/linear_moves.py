"""`LinearMoves`: rows of a dense plan as if driven in straight lines, and how near those are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, inner_products, norms
from irb2400_ctrl.planners.programs.rapid.rapid_data import angle_between, in_parts, quaternion

# turning 1 rad counts like this length on the way through a segment [m]
_ARM_OF_ROTATION = 0.1
# half a turn that is none [rad]
_NO_TURN = 1e-9


@dataclass(frozen=True)
class LinearMoves:
    """Moves that are straight in space and turn the shortest way, at even speed."""

    p: Array
    """the TCP at each row [m], shape (n, 3)"""
    quaternions: Array
    """its orientation, of the sign that is next to the row before, shape (n, 4)"""
    way: Array
    """from the first row to each, shape (n,) [m]"""

    @classmethod
    def of(cls, X: Array) -> LinearMoves:
        p = X[:, :3, 3]
        R = X[:, :3, :3]
        step = norms(np.diff(p, axis=0)) + _ARM_OF_ROTATION * in_parts(angle_between, R[:-1], R[1:])
        found = in_parts(quaternion, R)
        turned = inner_products(found[:-1], found[1:]) < 0
        signs = np.append(1.0, np.cumprod(np.where(turned, -1.0, 1.0)))
        way = np.append(0.0, np.cumsum(step))
        return cls(p, signs[:, None] * found, way)

    def close(self, first: int, last: int, tolerance: float, angle: float) -> bool:
        """Whether the rows between are so near to the move from one to another [m, rad].

        Args:
            first: row of the start.
            last: row of the end.
            tolerance: of the TCP [m].
            angle: of the tool's orientation [rad].
        """
        rows = slice(first, last + 1)
        share = shares(self.way[rows])
        p = self.p[rows]
        if not norms(p[0] + share[:, None] * (p[-1] - p[0]) - p).max() <= tolerance:
            return False
        planned = self.quaternions[rows]
        start = planned[0]
        end = planned[-1]
        if start @ end < 0:
            end = -end
        half = 2 * math.asin(min(0.5 * float(np.linalg.norm(end - start)), 1.0))
        parts = np.stack([1 - share, share])
        if half > _NO_TURN:
            parts = np.sin(half * parts) / math.sin(half)
        move = parts[0][:, None] * start + parts[1][:, None] * end
        sign = np.where(inner_products(move, planned) < 0, -1.0, 1.0)
        chord = norms(move - sign[:, None] * planned).max()
        return 4 * math.asin(min(0.5 * float(chord), 1.0)) <= angle


def shares(way: Array) -> Array:
    """Of the way from the first to the last; even where there is none."""
    length = way[-1] - way[0]
    return (way - way[0]) / length if length > 0 else np.linspace(0.0, 1.0, len(way))
