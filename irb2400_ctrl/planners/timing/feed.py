"""The programmed feed as a bound of the speed along the path, over whole cells."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.tcp_path import Enclosed, TcpPath
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.motion_limits import linear_bounds
from irb2400_ctrl.planners.timing.time_joint_path import FeedBound
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.toolpath.orientation import Orientation


def feed_bound(tcp: TcpPath, orientation: Orientation, followed: Followed) -> FeedBound:
    """Bounds of x at both ends of cells, (2, m), such that x between them, linear in s, keeps the
    feed: x |dp/ds|^2 <= feed^2 all over the cell, bounded, not sampled."""
    curve = orientation.curve
    joints = followed.joints
    by_segment = curve.path.feed[curve.origin]
    first = np.floor(followed.u[:-1] + 1e-9).astype(int)
    last = np.maximum(np.ceil(followed.u[1:] - 1e-9).astype(int) - 1, first)
    # a piece of the joint path may lead over several segments of the curve: the slowest counts
    by_piece = np.full(len(first), np.inf)
    for shift in range(int((last - first).max()) + 1):
        by_piece = np.minimum(
            by_piece, by_segment[np.minimum(first + shift, np.minimum(last, curve.segments - 1))]
        )

    def bound(s: Array) -> Array:
        feed = by_piece[joints.piece((s[:-1] + s[1:]) / 2)]
        if not np.isfinite(feed).any():
            return np.full((2, len(feed)), np.inf)
        return np.asarray(linear_bounds(_squared(tcp.enclosed_velocity(s))[:, :, None]) * feed**2)

    return bound


def feed_ratio(bound: FeedBound, law: TimeLaw) -> float | None:
    """Upper bound of the TCP's speed over the feed, at all times; None where no feed is
    programmed."""
    most = np.atleast_2d(bound(law.s))
    if not np.isfinite(most).any():
        return None
    return float(np.sqrt((law.above / most).max()))


def _squared(velocity: Enclosed) -> Array:
    """Bernstein coefficients of an upper bound of |dp/ds|^2 in each cell, (m, 5)."""
    squared = bernstein.product(velocity.points, velocity.points).sum(axis=2)
    return np.asarray(squared + (velocity.miss * (2 * velocity.size + velocity.miss))[:, None])
