"""The way along a tool path that a configuration known at one of its ends decides."""

from __future__ import annotations

from typing import Literal

import numpy as np

from irb2400_ctrl.arrays import Array, less_turns
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import cutting_moves
from irb2400_ctrl.planners.redundancy.choice import (
    Choice,
    clear,
    continuous_margins,
    stay_inside,
)
from irb2400_ctrl.planners.redundancy.follow import JointTarget, follow
from irb2400_ctrl.planners.toolpath.orientation import Orientation

End = Literal["first", "last"]
# how far the joints may be from the known configuration at the end [rad]
_SAME = 1e-5


def known_way(
    model: Model, orientation: Orientation, q: Array, end: End, scene: Scene | None = None
) -> Choice:
    """The joint path that has the configuration q (n,) [rad] at an end, whole turns included.

    Args:
        orientation: a path of full orientations, whose pose at that end q reaches.
        scene: the arm in its cell.

    Raises:
        UnreachableError: the branch of q ends on the way, or leaves the joint box, or
            (CollisionError) something is touched.
    """
    branch = _branch(model, orientation, q, end)
    target = JointTarget.of(orientation, lambda s: np.zeros(np.shape(s)), branch)
    followed = follow(model, target, None)
    row = 0 if end == "first" else -1
    ends = followed.joints(followed.joints.knots[[0, -1]])
    turns = 2 * np.pi * np.round((q - ends[row]) / (2 * np.pi))
    if turns.any():
        followed = follow(model, target, ends[0] + turns)
        ends = followed.joints(followed.joints.knots[[0, -1]])
    off = np.abs(ends[row] - q)
    if off.max() > _SAME:
        axis = int(np.argmax(off))
        raise UnreachableError(
            f"axis {axis + 1} would jump by {np.degrees(off[axis]):.1f} deg at the {end} point: "
            "the wrist is straight there; free the tool rotation, or move the work frame"
        )
    stay_inside(model, followed, target)
    margins = continuous_margins(model, followed)
    moves = cutting_moves(orientation.curve.path, orientation.spindle)
    clearance = clear(scene, followed, target, moves)
    return Choice(
        "given orientation",
        branch,
        lambda s: np.zeros(np.shape(s)),
        followed,
        margins,
        clearance,
    )


def _branch(model: Model, orientation: Orientation, q: Array, end: End) -> int:
    """Number of the closed-form branch that q belongs to."""
    at = 0.0 if end == "first" else float(orientation.curve.segments)
    X = orientation.poses(np.array([at]), np.zeros(1))
    away = less_turns(model.inverse_kinematics_branches(X).q[0] - q)
    return int(np.argmin(np.nan_to_num(np.abs(away).max(axis=1), nan=np.inf)))
