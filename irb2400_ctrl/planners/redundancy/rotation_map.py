"""`RotationMap`: what every tool rotation would leave of each margin, all along a tool path.

For the posture that was chosen; path length against tool rotation, the picture that shows why the
chosen line runs where it does, and where else it could.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask, less_turns
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import cutting_moves
from irb2400_ctrl.planners.clearance.room import room
from irb2400_ctrl.planners.joint_box import left_in_box
from irb2400_ctrl.planners.redundancy.choice import Choice
from irb2400_ctrl.planners.redundancy.choices import GRID, cutting_at, stations
from irb2400_ctrl.planners.redundancy.comfort import feed_and_torque, middled, part_of_comfort
from irb2400_ctrl.planners.redundancy.follow import arc_length
from irb2400_ctrl.planners.redundancy.singularity_margins import relative_margins
from irb2400_ctrl.planners.toolpath.orientation import Orientation

LIMITS = ("", "out of reach", "joint limits", "collision", "singularity", "torque", "feed")
"""what a place of the map meets; nothing first"""
SINGULAR = 0.02
"""relative margin below which a place is called a singularity [-]"""
_MOST_STATIONS = 240
_MOVES = 0.1
"""of the length of the path, below which the TCP stands and the tool turns"""


@dataclass(frozen=True, eq=False)
class RotationMap:
    """n stations along a path and r tool rotations."""

    way: Array
    """length of the TCP's way [m], shape (n,)"""
    rotation: Array
    """[rad], shape (r,)"""
    chosen: Array
    """rotation of the motion that is driven, continuous [rad], shape (n,)"""
    worth: Array
    """smallest margin as a part of what is comfortable; nan out of reach, shape (n, r)"""
    limit: Integers
    """index in `LIMITS` of what is met, shape (n, r)"""

    def summary(self) -> dict[str, Any]:
        """The content of `rotation_map.json`."""
        rows = [[None if np.isnan(v) else round(float(v), 3) for v in row] for row in self.worth]
        return {
            "schema_version": 1,
            "way_mm": [round(1e3 * float(v), 3) for v in self.way],
            "rotation_deg": [round(float(v), 3) for v in np.degrees(self.rotation)],
            "chosen_deg": [round(float(v), 3) for v in np.degrees(self.chosen)],
            "limits": list(LIMITS),
            "worst_margin": rows,
            "limit": self.limit.tolist(),
        }


def rotation_map(
    model: Model,
    orientation: Orientation,
    scene: Scene | None,
    choice: Choice,
    way_of: Callable[[Array], Array],
) -> RotationMap:
    """The map around a chosen motion, in its posture.

    Args:
        model: the arm with its tool.
        orientation: the tool path, placed and smoothed.
        scene: the arm in its cell; None where nothing is known of the space that it takes up.
        choice: the motion.
        way_of: from lengths along the path, which count the tool's turning, too, to those of the
            TCP's way [m].
    """
    curve = orientation.curve
    u = stations(orientation)
    u = u[np.unique(np.linspace(0, len(u) - 1, min(len(u), _MOST_STATIONS)).astype(int))]
    s = arc_length(curve, u)
    way = way_of(s)
    chosen = np.asarray(choice.rotation(s), dtype=float)
    q = _of_posture(model, orientation, u, choice)
    known = np.isfinite(q).all(axis=2)
    parts = np.full((4, *known.shape), np.nan)
    limit = np.where(known, 0, LIMITS.index("out of reach"))
    room = left_in_box(model.robot, q)
    parts[0] = part_of_comfort("joint_limits_deg", np.degrees(room))
    singular = relative_margins(model, q[known]).min(axis=1)
    parts[1][known] = part_of_comfort("singularity", singular)
    kept, left = feed_and_torque(model, q[known], _rate(orientation, u, _steps(s, way), q)[known])
    parts[2][known] = np.minimum(part_of_comfort("torque_left", left), kept)
    met = (("feed", kept < 1.0), ("torque", left <= 0), ("singularity", singular < SINGULAR))
    for name, where in met:
        limit[known] = np.where(where, LIMITS.index(name), limit[known])
    boxed = known & (np.nan_to_num(room, nan=-1.0) >= 0)
    parts[3] = _clearance(orientation, scene, u, q, boxed)
    limit[boxed & (parts[3] <= 0)] = LIMITS.index("collision")
    limit[known & ~boxed] = LIMITS.index("joint limits")
    worth = np.where(known, np.fmin.reduce(parts), np.nan)
    return RotationMap(way, GRID, chosen, worth, limit.astype(np.int64))


def _of_posture(model: Model, orientation: Orientation, u: Array, choice: Choice) -> Array:
    """Configurations in the branch that the motion is in, at every station and rotation of the
    grid, shape (n, r, joints)."""
    n = len(u)
    found = model.inverse_kinematics_branches(orientation.fan(u, GRID).reshape(-1, 4, 4)).q
    every = found.reshape(n, len(GRID), *found.shape[1:])
    own = orientation.poses(u, np.asarray(choice.rotation(arc_length(orientation.curve, u))))
    branches = model.inverse_kinematics_branches(own).q
    s = np.interp(u, choice.followed.u, choice.followed.joints.knots)
    driven = choice.followed.joints(s)[:, : model.robot.n]
    off = less_turns(branches - driven[:, None])
    branch = np.nan_to_num(np.abs(off), nan=np.inf).max(axis=2).argmin(axis=1)
    return middled(model, every[np.arange(n), :, branch])


def _steps(s: Array, way: Array) -> Array:
    """Which length the feed counts between stations [m], shape (n - 1,): the TCP's, but where it
    hardly moves, as the tool turns on the spot, that of the path."""
    along = np.diff(s)
    moved = np.diff(way)
    return np.maximum(np.where(moved > _MOVES * along, moved, along), 1e-9)


def _rate(orientation: Orientation, u: Array, steps: Array, q: Array) -> Array:
    """Joint speeds at the feed with a constant rotation, zero where no feed is stated, [rad/s],
    shape (n, r, joints).

    Args:
        orientation: the tool path.
        u: stations, shape (n,).
        steps: lengths between them that the feed counts [m], shape (n - 1,).
        q: configurations, shape (n, r, joints).
    """
    curve = orientation.curve
    slope = less_turns(np.diff(q, axis=0)) / steps[:, None, None]
    # of the two neighbours the steeper one; at an end, or beside a gap, the only one
    before = np.concatenate([np.zeros_like(slope[:1]), slope])
    after = np.concatenate([slope, np.zeros_like(slope[:1])])
    before = np.nan_to_num(before)
    after = np.nan_to_num(after)
    steeper = np.where(np.abs(before) > np.abs(after), before, after)
    feed = curve.path.feed[curve.origin[np.minimum(u.astype(int), curve.segments - 1)]]
    return np.asarray(steeper * np.where(np.isfinite(feed), feed, 0.0)[:, None, None])


def _clearance(
    orientation: Orientation, scene: Scene | None, u: Array, q: Array, asked: Mask
) -> Array:
    """Room beside what is to be kept, as a part of what is comfortable, shape (n, r)."""
    found = np.full(asked.shape, np.nan)
    if scene is None or not asked.any():
        return found
    moves = cutting_moves(orientation.curve.path, orientation.spindle)
    at_feed = np.broadcast_to(cutting_at(orientation.curve, moves, u)[:, None], asked.shape)
    turned = np.repeat(orientation.external(u)[:, None], asked.shape[1], axis=1)
    every = np.concatenate([q, turned], axis=2)
    free = room(scene, every[asked], at_feed[asked])
    found[asked] = part_of_comfort("clearance_mm", 1e3 * free)
    return found
