"""`WayOut`: lines from the ends of a tool path that the arm has to reach along, too."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, less_turns
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.redundancy.known_way import End, known_way
from irb2400_ctrl.planners.redundancy.ladder_graph import BOX_INSET, Ladder
from irb2400_ctrl.planners.redundancy.ladder_moves import LARGEST_STEP
from irb2400_ctrl.planners.toolpath.orientation import Orientation, shape_path
from irb2400_ctrl.planners.toolpath.task_curve import TOLERANCE
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

# places looked at on each side of a line
_PLACES = 4


@dataclass(frozen=True)
class WayOut:
    """Where the tool goes, without turning, from the first and the last point of a path."""

    first: Array | None
    """places from the first way-point outwards [m], shape (k, 3); None where nothing is asked"""
    last: Array | None
    """the same from the last way-point"""

    @property
    def ends(self) -> list[tuple[End, Array]]:
        """The ends that have a line."""
        found: list[tuple[End, Array]] = []
        if self.first is not None and len(self.first) > 1:
            found.append(("first", self.first))
        if self.last is not None and len(self.last) > 1:
            found.append(("last", self.last))
        return found

    def kept(self, ladder: Ladder, orientation: Orientation) -> Ladder:
        """The ladder without the nodes of its ends whose line leaves the joint box or their
        branch; as it is, where that leaves nothing of an end."""
        q = ladder.q.copy()
        margin = ladder.margin.copy()
        for end, places in self.ends:
            row = 0 if end == "first" else len(q) - 1
            X = orientation.fan(ladder.u[row : row + 1], ladder.rotation)[0]
            left = np.isfinite(q[row]).all(axis=-1)
            left &= way_is_free(ladder.model, X, q[row], places)
            if left.any():
                q[row][~left] = np.nan
                margin[row][~left] = -1.0
        return replace(ladder, q=q, margin=margin)

    def check(
        self, model: Model, orientation: Orientation, followed: Followed, scene: Scene | None = None
    ) -> None:
        """Refuse a joint path whose ends have no continuous way along their line.

        Raises:
            UnreachableError: says which line, which axis, or (CollisionError) what is touched.
        """
        for end, places in self.ends:
            knots = followed.joints.knots
            both = followed.joints(knots[:1] if end == "first" else knots[-1:])[0]
            q = both[: model.robot.n]
            around = None if scene is None else scene.standing(both[model.robot.n :])
            X = model.tcp_pose(q)
            name = "line from the clearance plane" if end == "first" else "line to it"
            moved = places - places[0] + X[:3, 3]
            line = ToolPath(moved, rotation=np.tile(X[:3, :3], (len(moved), 1, 1)), name=name)
            known_way(model, shape_path(line, orientation.spindle, TOLERANCE), q, "first", around)


def way_is_free(model: Model, X: Array, q: Array, places: Array) -> Array:
    """Whether nodes can be left along the places without a jump and within the joint box, whole
    turns apart.

    Args:
        X: poses of the nodes (r, 4, 4); the tool does not turn.
        q: their configurations [rad], shape (r, 8, 6).
        places: where the tool goes from there [m], shape (k, 3), the first its own.
    """
    low = model.robot.q_min + BOX_INSET
    high = model.robot.q_max - BOX_INSET
    room = high - low
    left = np.ones(q.shape[:2], dtype=bool)
    before = q
    furthest = np.zeros((2, *q.shape))
    for a, b in itertools.pairwise(places):
        for part in np.arange(1, _PLACES + 1) / _PLACES:
            moved = X.copy()
            moved[:, :3, 3] = a + part * (b - a)
            now = model.inverse_kinematics_branches(moved).q.reshape(q.shape)
            step = less_turns(now - before)
            with np.errstate(invalid="ignore"):
                left &= (np.abs(step) < LARGEST_STEP).all(axis=-1)
            before = before + step
            furthest = np.stack(
                [np.minimum(furthest[0], before - q), np.maximum(furthest[1], before - q)]
            )
    with np.errstate(invalid="ignore"):
        # some whole turn must leave room for the line on either side
        least = np.ceil((low - q - furthest[0]) / (2 * np.pi) - 1e-12)
        most = np.floor((high - q - furthest[1]) / (2 * np.pi) + 1e-12)
        left &= ((least <= most) & (furthest[1] - furthest[0] <= room)).all(axis=-1)
    return left
