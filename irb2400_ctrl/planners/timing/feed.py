"""The programmed feed as a bound of the speed along the path, over whole cells."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.time_joint_path import FeedBound
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.toolpath.orientation import Orientation


def feed_bound(tcp: TcpPath, orientation: Orientation, followed: Followed) -> FeedBound:
    """(feed / |dp/ds|)^2 within cells, with the largest |dp/ds| of each cell bounded, not
    sampled."""
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
            return np.full(len(feed), np.inf)
        return np.asarray((feed / np.maximum(tcp.enclosed_velocity(s).size, 1e-9)) ** 2)

    return bound


def feed_ratio(bound: FeedBound, law: TimeLaw) -> float | None:
    """Upper bound of the TCP's speed over the feed, at all times; None where no feed is
    programmed."""
    most = bound(law.s)
    if not np.isfinite(most).any():
        return None
    return float(np.sqrt((law.largest / most).max()))
