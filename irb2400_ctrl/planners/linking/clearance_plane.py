"""`ClearancePlane`: where the tool may move freely above a part, and how it gets there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.redundancy.way_out import WayOut
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

Mask = npt.NDArray[np.bool_]

# tool axes that agree less than this on average leave the choice of up to the base [-]
_AGREE = 0.3
# tools steeper than this go up to the plane along their own axis (cosine) [-]
_STEEP = 0.9
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class ClearancePlane:
    """A plane above everything that the program cuts; up is the mean direction of its tool axes."""

    up: Array
    """unit vector in the base, shape (3,)"""
    height: float
    """of the plane along `up` [m]"""
    clearance: float
    """of the plane above the highest cut [m]"""

    @classmethod
    def over(
        cls,
        paths: Sequence[tuple[ToolPath, Mask]],
        spindle: Array,
        clearance: float,
        vertical: Array = _UP,
    ) -> ClearancePlane:
        """Above all cuts of paths in the base.

        Args:
            paths: to each belongs which moves are rapid, shape (n,).
            spindle: direction of the tool in the TCP frame, out of the spindle, shape (3,).
            clearance: over the highest cut [m].
            vertical: in the base, what is up where the tool axes do not agree, shape (3,).
        """
        kept = [cutting_points(rapid) for _, rapid in paths]
        places = np.concatenate([p.position[k] for (p, _), k in zip(paths, kept, strict=True)])
        axes = [p.tool_axis(spindle)[k] for (p, _), k in zip(paths, kept, strict=True)]
        mean = np.concatenate(axes).mean(axis=0)
        length = float(np.linalg.norm(mean))
        up = mean / length if length > _AGREE else vertical
        return cls(up, float((places @ up).max()) + clearance, clearance)

    def above(self, place: Array) -> Array:
        """Height of places (..., 3) over the plane, shape (...) [m]; negative below it."""
        return np.asarray(place @ self.up - self.height)

    def way_outs(self, path: ToolPath, spindle: Array, approach: float) -> WayOut:
        """From both ends of a path in the base."""
        axis = path.tool_axis(spindle)
        first, last = [self.way_out(path.position[k], axis[k], approach) for k in (0, -1)]
        return WayOut(first, last)

    def way_out(self, place: Array, axis: Array, approach: float) -> Array:
        """Places from a way-point up to the plane, shape (k, 3): along the tool axis first, and
        straight up from there where the tool is inclined. Only the way-point itself where it is
        above the plane already.
        """
        missing = -float(self.above(place))
        if missing <= 1e-6:
            return place[None]
        steep = float(axis @ self.up)
        if steep >= _STEEP:
            return np.array([place, place + max(missing / steep, approach) * axis])
        out = place + max(self.clearance, approach) * axis
        lift = -float(self.above(out))
        places = [place, out] if lift <= 1e-6 else [place, out, out + lift * self.up]
        return np.array(places)


def cutting_points(rapid: Mask) -> Mask:
    """Way-points at either end of a move that is not rapid, shape (n,); all, if every move is
    rapid."""
    cut = ~rapid[1:]
    found = np.zeros(len(rapid), dtype=bool)
    found[1:] |= cut
    found[:-1] |= cut
    return found if found.any() else np.ones(len(rapid), dtype=bool)
