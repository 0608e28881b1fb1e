"""Ways of the joints around something, between two configurations that no bent line joins.

Two trees of straight moves grow from both ends towards drawn configurations and towards each other
(RRT-Connect: Kuffner and LaValle, ICRA 2000). The corners of what joins them are cut where the
straight move is free, and rounded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from math import factorial

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.joint_path import JointPath

Free = Callable[[Array], bool]
"""whether an arm may stand at all of some configurations (m, n) [rad]"""

# of the trees: one move, and the distance of the places that are looked at on it [rad]
_STEP = 0.3
_LOOKED_AT = 0.03
# how far beside both ends configurations are drawn [rad]: the arm's axes, then those of the wrist,
# which follow the arm at first
_ASIDE = ((2.0, 0.3), (2.0, 2.0))
_ARM = 3
_DRAWN = 400
# control points on the straight moves are so near to each other: the nearer, the sharper the
# corners [rad]
_SPACINGS = (0.6, 0.3, 0.1)
_MOST = 200


def ways_around(
    q_from: Array, q_to: Array, box: tuple[Array, Array], free: Free
) -> Iterator[JointPath]:
    """Smooth joint paths that may be free, the rounder ones first; the caller looks closely.

    Args:
        q_from, q_to: ends [rad], shape (n,).
        box: least and largest angles [rad], shape (n,) each.
        free: told of some places of a move, not of all.
    """
    n = len(q_from)
    for arm, wrist in _ASIDE:
        aside = np.where(np.arange(n) < _ARM, arm, wrist)
        low = np.maximum(box[0], np.minimum(q_from, q_to) - aside)
        high = np.minimum(box[1], np.maximum(q_from, q_to) + aside)
        corners = _joined(q_from, q_to, (low, high), free)
        if corners is None:
            continue
        corners = _shortened(corners, free)
        for spacing in _SPACINGS:
            yield _rounded(corners, spacing)


@dataclass
class _Tree:
    """Configurations, each reached by a free straight move from the one at `parents`."""

    q: list[Array]
    parents: list[int] = field(default_factory=lambda: [-1])

    def towards(self, goal: Array, free: Free, *, once: bool) -> bool:
        """Grow by one move, or until the goal is reached; whether it is."""
        at = int(np.argmin(np.linalg.norm(np.array(self.q) - goal, axis=1)))
        while True:
            here = self.q[at]
            way = float(np.linalg.norm(goal - here))
            there = goal if way <= _STEP else here + _STEP / way * (goal - here)
            if not _move_is_free(here, there, free):
                return False
            self.q.append(there)
            self.parents.append(at)
            at = len(self.q) - 1
            if way <= _STEP:
                return True
            if once:
                return False

    def branch(self) -> list[Array]:
        """From the last configuration back to the root."""
        found = []
        at = len(self.q) - 1
        while at >= 0:
            found.append(self.q[at])
            at = self.parents[at]
        return found


def _joined(q_from: Array, q_to: Array, box: tuple[Array, Array], free: Free) -> list[Array] | None:
    """Corners of a free way; None where none is found."""
    draw = np.random.default_rng(0)
    trees = [_Tree([q_from]), _Tree([q_to])]
    for turn in range(_DRAWN):
        one = trees[turn % 2]
        other = trees[1 - turn % 2]
        before = len(one.q)
        one.towards(draw.uniform(*box), free, once=True)
        if len(one.q) > before and other.towards(one.q[-1], free, once=False):
            return [*trees[0].branch()[::-1], *trees[1].branch()[1:]]
    return None


def _move_is_free(here: Array, there: Array, free: Free) -> bool:
    count = int(np.ceil(np.abs(there - here).max() / _LOOKED_AT)) + 1
    share = np.linspace(0.0, 1.0, max(count, 2))[1:, None]
    return free(here + share * (there - here))


def _shortened(corners: list[Array], free: Free) -> list[Array]:
    """From each corner on to the farthest one that a straight move reaches."""
    found = [corners[0]]
    at = 0
    while at < len(corners) - 1:
        farther = range(len(corners) - 1, at + 1, -1)
        at = next((k for k in farther if _move_is_free(found[-1], corners[k], free)), at + 1)
        found.append(corners[at])
    return found


def _rounded(corners: list[Array], spacing: float) -> JointPath:
    """The cubic B-spline whose control points are on the straight moves: it stays in their hull."""
    from scipy.interpolate import BSpline

    control = [corners[0]]
    for here, there in pairwise(corners):
        count = np.clip(np.ceil(np.linalg.norm(there - here) / spacing), 3, _MOST)
        control += list(here + np.arange(1, count + 1)[:, None] / count * (there - here))
    points = np.array(control)
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    knots = np.concatenate([way[:1], (way[1:-3] + way[2:-2] + way[3:-1]) / 3, way[-1:]])
    spline = BSpline(np.pad(knots, 3, mode="edge"), points, 3)
    powers = [spline(knots[:-1], order) / factorial(order) for order in range(4)]
    return JointPath(knots, np.array(powers))
