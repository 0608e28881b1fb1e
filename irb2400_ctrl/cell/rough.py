"""`Rough`: lower bounds of the distances to a cell for many configurations at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.piece import Piece

# points on the axis of a body are no further apart than this [m]
_SPACING = 0.06


class Rough:
    """Points on the axes of capsules around the bodies, against boxes around the things.

    No point of a capsule is further than radius + half the spacing from such a point; so the
    distance from the points to the box, less that, is a lower bound.
    """

    def __init__(
        self,
        arm: Sequence[Piece],
        things: Sequence[Piece],
        pairs: Sequence[tuple[int, int]],
        poses: Sequence[int],
    ) -> None:
        """`poses`: which of the poses of a configuration the body of each pair has."""
        self._poses = list(poses)
        self._points = []
        self._margins = []
        for piece in arm:
            ends, radius = piece.capsule()
            length = float(np.linalg.norm(ends[1] - ends[0]))
            count = int(np.ceil(length / _SPACING))
            part = (np.arange(max(count, 1)) + 0.5) / max(count, 1)
            self._points.append(ends[0] + part[:, None] * (ends[1] - ends[0]))
            self._margins.append(radius + length / max(count, 1) / 2)
        self._boxes = [(np.linalg.inv(piece.pose()), piece.half_size()) for piece in things]
        self._pairs = list(pairs)

    def __call__(self, poses: Array) -> Array:
        """Lower bounds at the poses of configurations (m, …, 3, 4), shape (m, pairs) [m]."""
        placed: dict[tuple[int, int], Array] = {}
        found = np.empty((len(poses), len(self._pairs)))
        for number, (i, k) in enumerate(self._pairs):
            body = i, self._poses[number]
            if body not in placed:
                X = poses[:, self._poses[number]]
                points = np.einsum("mij,kj->mki", X[:, :, :3], self._points[i])
                placed[body] = points + X[:, None, :, 3]
            X_KB, half = self._boxes[k]
            local = placed[body] @ X_KB[:3, :3].T + X_KB[:3, 3]
            outside = np.maximum(np.abs(local) - half, 0.0)
            gap = np.sqrt((outside**2).sum(axis=2)).min(axis=1)
            found[:, number] = gap - self._margins[i]
        return found
