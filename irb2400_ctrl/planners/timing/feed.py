"""The programmed feed as a bound of the speed along the path, over whole cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.tcp_path import Enclosed, TcpPath
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.motion_limits import linear_bounds
from irb2400_ctrl.planners.timing.time_joint_path import FeedBound
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.toolpath.orientation import Orientation


def programmed_feed(orientation: Orientation, followed: Followed) -> Array:
    """The feed on every piece of a joint path, inf where there is none [m/s], shape (m,)."""
    curve = orientation.curve
    by_segment = curve.path.feed[curve.origin]
    first = np.floor(followed.u[:-1] + 1e-9).astype(int)
    last = np.maximum(np.ceil(followed.u[1:] - 1e-9).astype(int) - 1, first)
    # a piece of the joint path may lead over several segments of the curve: the slowest counts
    by_piece = np.full(len(first), np.inf)
    for shift in range(int((last - first).max()) + 1):
        by_piece = np.minimum(
            by_piece, by_segment[np.minimum(first + shift, np.minimum(last, curve.segments - 1))]
        )
    return by_piece


def feed_bound(tcp: TcpPath, by_piece: Array) -> FeedBound:
    """Bounds of x at both ends of cells, (2, m), such that x between them, linear in s, keeps the
    feed: x |dp/ds|^2 <= feed^2 all over the cell, bounded, not sampled."""
    joints = tcp.joints

    def bound(s: Array) -> Array:
        feed = by_piece[joints.piece((s[:-1] + s[1:]) / 2)]
        if not np.isfinite(feed).any():
            return np.full((2, len(feed)), np.inf)
        return np.asarray(linear_bounds(_squared(tcp.enclosed_velocity(s))[:, :, None]) * feed**2)

    return bound


def feed_ratios(
    tcp: TcpPath, by_piece: Array, law: TimeLaw, places: JointPath
) -> tuple[Array, Array] | None:
    """Upper bounds of the TCP's speed over the feed in cells of time: their ends (m + 1,) [s] and
    the ratios (m,); None where no feed is programmed.

    Args:
        tcp: along the joint path that was timed.
        by_piece: the feed on its pieces [m/s].
        law: when it is where: says which feed counts.
        places: the joints over the time, as the controller has them.
    """
    if not np.isfinite(by_piece).any():
        return None
    joints = tcp.joints
    changes = joints.knots[1:-1][by_piece[1:] != by_piece[:-1]]
    # knots are grid points of the law, up to slivers
    passed = law.time[np.minimum(np.searchsorted(law.s, changes), len(law.s) - 1)]
    rows = np.unique(np.concatenate([places.knots, passed[passed < places.knots[-1]]]))
    cells = divided(rows, np.full(len(rows) - 1, 2))
    s = law.at((cells[:-1] + cells[1:]) / 2)[0]
    speed = replace(tcp, joints=places).largest_velocity(cells)
    return cells, speed / by_piece[joints.piece(s)]


def _squared(velocity: Enclosed) -> Array:
    """Bernstein coefficients of an upper bound of |dp/ds|^2 in each cell, (m, 5)."""
    squared = bernstein.product(velocity.points, velocity.points).sum(axis=2)
    return np.asarray(squared + (velocity.miss * (2 * velocity.size + velocity.miss))[:, None])
