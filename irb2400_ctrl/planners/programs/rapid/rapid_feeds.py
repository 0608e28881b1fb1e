"""Where the feeds that a plan was made for change, and where its way turns back, row by row."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, norms
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.toolpath.task_curve import turning_back

# how long before or after the time of a way-point the row beside it is looked for [s]
_AROUND = 0.04
# a row farther than this from its way-point is none beside it [m]
_BESIDE = 1e-3


def feeds_of_rows(plan: Plan) -> Array:
    """Programmed feed of the way to each row of the plan's trajectory, inf where there is none
    [m/s], shape (n,)."""
    time = plan.trajectory.time
    feed = plan.path.feed.copy()
    feed[0] = feed[1]
    found = np.full(len(time), feed[-1])
    # from the last change to the first
    for point in np.flatnonzero(feed[1:] != feed[:-1])[::-1]:
        found[: _row_at(plan, int(point)) + 1] = feed[point]
    return found


def rows_that_stop(plan: Plan) -> Mask:
    """Rows at which the way turns back, shape (n,): a corner zone there would leave, say, the
    bottom of a hole by half its radius."""
    found = np.zeros(len(plan.trajectory.time), dtype=bool)
    found[[_row_at(plan, int(point)) for point in turning_back(plan.path)]] = True
    return found


def _row_at(plan: Plan, point: int) -> int:
    """The row beside a way-point: rows are a little later than the time law of its time."""
    time = plan.trajectory.time
    expected = float(plan.point_times[point] * time[-1] / plan.point_times[-1])
    first, last = np.searchsorted(time, [expected - _AROUND, expected + _AROUND])
    q = plan.trajectory.q[first:last]
    if plan.carried is None and len(q):
        away = norms(Model(plan.robot).tcp_pose(q)[:, :3, 3] - plan.path.position[point])
        if away.min() < _BESIDE:
            return int(first + np.argmin(away))
    return min(int(np.searchsorted(time, expected)), len(time) - 1)
