"""The clearance of a joint path at every place of it, not only at samples: branch and bound.

In a cell of the path between s_0 and s_1 with the middle s_m, no point of a body moves further than

    (s_1 - s_0) / 2 max |v(s)|

in the eyes of another one (`cell/reach.py`), so their distance is at least that at s_m less this.
Cells whose bound lies too far below the smallest distance that was seen are cut further; what is
left is a lower bound for the whole path, and close to the truth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.planners.clearance.clearance import Clearance
from irb2400_ctrl.planners.grids import cut
from irb2400_ctrl.planners.joint_path import JointPath

CONTACT = 5e-5
"""a distance, above what is to be kept, that cannot be told from contact [m]"""
# the bound lies below the truth by no more than this [m] and this part of it
_BELOW = 1e-4
_PART = 0.03
_MOST_PARTS = 16
_CHUNK = 4096


@dataclass(frozen=True)
class Approach:
    """Where two bodies come nearest, as far as it was seen."""

    distance: float
    pair: int
    s: float


@dataclass
class _Search:
    """What is known of the smallest distance so far."""

    scene: Scene
    joints: JointPath
    keep: float
    """[m]"""
    seen: Approach
    """the smallest distance at any sample"""
    bound: Approach
    """the smallest bound of cells that are done"""

    def goal(self) -> float:
        """Bounds above this need no closer look [m]."""
        distance = self.seen.distance
        if not np.isfinite(distance):
            return np.inf
        slack = _BELOW + _PART * max(distance, 0.0)
        if distance > self.keep:
            slack = min(slack, (distance - self.keep) / 2)
        return distance - slack

    @property
    def touching(self) -> bool:
        """Whether a sample shows that the motion is not free."""
        return self.seen.distance <= self.keep + CONTACT


def continuous_clearance(
    scene: Scene, joints: JointPath, cutting: npt.NDArray[np.bool_] | None
) -> Clearance:
    """A lower bound of the smallest distance over the whole path.

    Where it cannot be shown that `scene.kept` is kept, the search ends with the place and the pair
    that say so.

    Args:
        scene: the arm in its cell.
        joints: the path.
        cutting: whether what cuts may touch what may be cut, for each piece of the path, shape
            (m,); None for a path that no program states: it keeps `scene.keep` from everything.
    """
    open_ = np.ones((len(joints.knots) - 1, scene.pairs), dtype=bool)
    if cutting is None:
        return _searched(scene, joints, open_, scene.keep)
    open_ &= ~(cutting[:, None] & scene.cutting)
    if (scene.kept == scene.keep).all():
        return _searched(scene, joints, open_, scene.keep)
    others = _searched(scene, joints, open_ & ~scene.cutting, scene.keep)
    if not others.free:
        return others
    tool = _searched(scene, joints, open_ & scene.cutting, 0.0)
    return others if tool.free and others.value <= tool.value else tool


def _searched(
    scene: Scene, joints: JointPath, open_: npt.NDArray[np.bool_], keep: float
) -> Clearance:
    """Of the pairs that are open in each piece of the path, (m, pairs)."""
    nothing = Approach(np.inf, 0, float(joints.knots[0]))
    search = _Search(scene, joints, keep, nothing, nothing)
    some = open_.any(axis=1)
    ends = np.stack([joints.knots[:-1], joints.knots[1:]])[:, some]
    open_ = open_[some]
    _first_look(search, ends, open_)
    while len(open_) and not search.touching:
        following = []
        for first in range(0, len(open_), _CHUNK):
            part = slice(first, first + _CHUNK)
            following.append(_step(search, ends[:, part], open_[part]))
            if search.touching:
                break
        ends = np.concatenate([cells for cells, _ in following], axis=1)
        open_ = np.concatenate([pairs for _, pairs in following])
    at = search.seen
    value = at.distance if search.touching else min(search.bound.distance, at.distance)
    return Clearance(value, scene.names(at.pair), at.s, not search.touching, keep)


def _first_look(search: _Search, ends: Array, open_: npt.NDArray[np.bool_]) -> None:
    """A few samples along the path: a small distance found early spares most of the others."""
    for at in np.unique(np.linspace(0, len(open_) - 1, 40 if len(open_) else 0).astype(int)):
        _distances(search, ends[:, at : at + 1], open_[at : at + 1], np.zeros((1, 1)))
        if search.touching:
            break


def _step(
    search: _Search, ends: Array, open_: npt.NDArray[np.bool_]
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Bound the open pairs of the cells (2, m); the parts of cells that need a closer look, with
    the pairs that are still open there."""
    width = ends[1] - ends[0]
    moved = search.scene.speed(_rate(search.joints, ends)) * width[:, None] / 2
    distance = _distances(search, ends, open_, moved)
    goal = search.goal()
    bound = np.where(open_, distance - moved, np.inf)
    wide = bound < goal
    done = np.where(wide, np.inf, bound)
    at = np.unravel_index(int(np.argmin(done)), done.shape)
    if done[at] < search.bound.distance:
        search.bound = Approach(float(done[at]), int(at[1]), float(ends[:, at[0]].mean()))
    again = np.flatnonzero(wide.any(axis=1))
    # the bound of a part is about distance - moved / parts: cut as finely as that needs
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = np.where(wide, moved / np.maximum(distance - goal, 1e-12), 0.0)[again]
    parts = np.clip(np.ceil(needed.max(axis=1, initial=0.0)), 2, _MOST_PARTS).astype(int)
    return cut(ends[:, again], parts), np.repeat(wide[again], parts, axis=0)


def _distances(search: _Search, ends: Array, open_: npt.NDArray[np.bool_], moved: Array) -> Array:
    """Distances in the middle of the cells, or lower bounds where these are enough, shape (m,
    pairs)."""
    scene = search.scene
    middle = ends.mean(axis=0)
    own, poses = scene.near(search.joints(middle))
    count = len(scene.own)
    found = np.full(open_.shape, np.inf)
    found[:, :count] = own
    measured = np.array(scene.measured, dtype=np.int64)
    known = np.delete(np.arange(count), measured[measured < count])
    _saw(search, np.where(open_[:, known], own[:, known], np.inf), known, middle)
    if not len(measured):
        return found
    if scene.outer:
        found[:, count:] = scene.rough(poses)
    looks = np.where(open_, found - moved, np.inf)
    for number in measured[np.argsort(looks[:, measured].min(axis=0))]:
        close = np.flatnonzero(looks[:, number] < search.goal())
        # near ones first: what they show may spare the others
        close = close[np.argsort(looks[close, number], kind="stable")]
        for some in np.array_split(close, max(1, len(close) // 64)):
            some = some[looks[some, number] < search.goal()]
            if not len(some):
                continue
            exact = scene.distance(int(number), poses[some])
            found[some, number] = exact
            _saw(search, exact[:, None], np.array([number]), middle[some])
        if search.touching:
            break
    return found


def _saw(search: _Search, distance: Array, pairs: Integers, s: Array) -> None:
    """Remember the smallest of true distances (m, k) of pairs (k,)."""
    if not distance.size:
        return
    at = np.unravel_index(int(np.argmin(distance)), distance.shape)
    if distance[at] < search.seen.distance:
        search.seen = Approach(float(distance[at]), int(pairs[at[1]]), float(s[at[0]]))


def _rate(joints: JointPath, ends: Array) -> Array:
    """Bernstein coefficients of dq/ds, a parabola in each cell that they enclose, (m, 3, n)."""
    first, last = ends
    piece = joints.piece((first + last) / 2)
    slope = joints.on_piece(first, piece, 1)
    rise = joints.on_piece(first, piece, 2) * (last - first)[:, None]
    return np.stack([slope, slope + rise / 2, joints.on_piece(last, piece, 1)], axis=1)
