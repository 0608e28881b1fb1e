"""`time_joint_path`: any joint path to its fastest certified time law, cells as fine as the path
needs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.enclosure.cells import Cells, enclose, grid
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.time_optimal import remainder_share, time_path
from irb2400_ctrl.typed import typed

FeedBound = Callable[[Array], Array]
"""bound of x = sdot^2 within each cell between lengths s (m + 1,), shape (m,), or at both ends of
each, shape (2, m)"""

_ROUNDS = 6
# cells whose enclosure costs more than this part of a torque limit are split
_SHARE = 3e-3


@typed
def time_joint_path(
    dynamics: PathDynamics,
    path: JointPath,
    limits: MotionLimits,
    *,
    count: int = 1000,
    feed: FeedBound | None = None,
) -> tuple[PiecewiseConstantLaw, Cells]:
    """The certified time law of a joint path, and the cells it stands on.

    Args:
        dynamics: torque along the path; path: q(s) [rad].
        limits: of torque, speed, acceleration, jerk and rates.
        count: cells that the path is cut into; feed: bound of the TCP's speed, if any.

    Raises:
        InfeasibleError: no motion within the limits; says where, and which axis lacks what.
    """
    friction = dynamics.friction
    s = grid(path, count)
    rounds = 0
    while True:
        rounds += 1
        cells = enclose(dynamics, path, s)
        bound = None if feed is None else feed(s)
        law = None
        problem = None
        try:
            law = time_path(cells, limits, friction, bound)
        except InfeasibleError as error:
            problem = error
        share = remainder_share(cells, limits, friction, None if law is None else law.x, bound)
        wide = share > _SHARE
        if not wide.any() or rounds == _ROUNDS:
            if law is None:
                raise problem or InfeasibleError("no motion within the limits")
            return law, cells
        # Cauchy's bound falls with the third power of the width
        parts = np.where(wide, np.clip(np.ceil(np.cbrt(2 * share / _SHARE)), 2, 8), 1).astype(int)
        s = divided(s, parts)
        # not beside the finer ones
        del cells
