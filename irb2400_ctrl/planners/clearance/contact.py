"""On which moves the cutting part of a tool may touch the part."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

# places and directions closer than this are the same [m, -]
_SAME = 1e-6


def cutting_moves(path: ToolPath, spindle: Array) -> npt.NDArray[np.bool_]:
    """Whether the tool may cut on the way to each way-point, shape (n,).

    It may on moves with a feed, and on all moves of a path that states none at all. A rapid move
    may touch the part only where it draws the tool back along its own axis, or puts it back along
    that axis to where it has been at feed (out of a hole, and into it again).

    Args:
        path: the way-points.
        spindle: direction of the tool in the TCP frame, out of the spindle, shape (3,).
    """
    stated = np.isfinite(path.feed)
    if not stated.any():
        return np.ones(len(path), dtype=bool)
    allowed = stated.copy()
    allowed[0] = True
    position = path.position
    axis = path.tool_axis(spindle)
    step = np.diff(position, axis=0, prepend=position[:1])
    height = (step * axis).sum(axis=1)
    across = np.linalg.norm(step - height[:, None] * axis, axis=1)
    turned = np.linalg.norm(np.diff(axis, axis=0, prepend=axis[:1]), axis=1)
    along = (across < _SAME) & (turned < _SAME)
    for i in np.flatnonzero(~allowed & along):
        if height[i] >= 0:
            allowed[i] = True
        else:
            cut = np.flatnonzero(allowed[:i] & along[:i] & (np.abs(height[:i]) > _SAME))
            allowed[i] = _been_there(position[i], axis[i], position[cut])
    return allowed


def _been_there(end: Array, axis: Array, reached: Array) -> bool:
    """Whether a place (3,) lies on the line along the axis through one of the places reached (m,
    3), no deeper than that."""
    offset = end - reached
    height = offset @ axis
    beside = np.linalg.norm(offset - height[:, None] * axis, axis=1)
    return bool(((beside < _SAME) & (height > -_SAME)).any())
