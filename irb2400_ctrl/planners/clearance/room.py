"""How much room a configuration has beside what is to be kept, as it is compared with others.

How near a cutter comes to what it may cut is its program's to say and the same wherever the part
stands and however the tool is turned: it counts where they touch alone.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene

COMFORTABLE_CLEARANCE = 0.02
"""distance beyond which more of it is worth nothing [m]"""
# nothing beyond a touch is looked at closely [m]
_TOUCH = 1e-9


def room(
    scene: Scene,
    q: Array,
    cutting: npt.NDArray[np.bool_],
    pairs: npt.NDArray[np.bool_] | None = None,
) -> Array:
    """Of configurations q (m, n), at most what is comfortable; zero or less where something comes
    too near, shape (m,) [m].

    Args:
        scene: the arm in its cell.
        q: [rad].
        cutting: where what cuts may touch what may be cut, shape (m,).
        pairs: those to look at, shape (pairs,); default all.
    """
    asked = np.ones(scene.pairs, dtype=bool) if pairs is None else pairs
    found = scene.clearance(q, cutting, COMFORTABLE_CLEARANCE, asked & ~scene.cutting, scene.kept)
    rapid = np.flatnonzero(~cutting & (found > 0))
    meeting = asked & scene.cutting
    if len(rapid) and meeting.any():
        touches = scene.clearance(q[rapid], cutting[rapid], _TOUCH, meeting)
        found[rapid] = np.where(touches > 0, found[rapid], touches)
    return found
