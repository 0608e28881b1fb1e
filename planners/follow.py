"""From the curve of the tool to joint angles: closed form at stations, a spline between them, stations where needed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.orientation import Orientation
from irb2400_ctrl.planners.task_curve import TaskCurve

Array = npt.NDArray[np.float64]
RotationLaw = Callable[[Array], Array]
"""free rotation [rad] over the length along the path [m]"""

# distance between stations to start with [m]
COARSE = 0.02
# a joint that moves further between stations is looked at more closely [rad]
JOINT_STEP = 0.15
MAX_ROUNDS = 14


@dataclass(frozen=True)
class Followed:
    """A joint path and how it belongs to the curve of the tool."""

    joints: JointPath
    u: Array
    """curve parameter at the knots of the joint path, shape (m + 1,)"""
    error: float
    """largest distance of the TCP from the curve, between stations [m]"""
    axis_error: float
    """largest angle of the tool axis to the curve's, between stations [rad]"""


def station_parameters(curve: TaskCurve, spacing: float) -> Array:
    """Curve parameters at every knot and, on long segments, in between so that `spacing` [m] is kept."""
    knots = np.arange(curve.segments + 1.0)
    count = np.maximum(1, np.ceil(curve.lengths(knots) / spacing).astype(int))
    pieces = [k + np.arange(c) / c for k, c in enumerate(count)]
    return np.concatenate([*pieces, [float(curve.segments)]])


def arc_length(curve: TaskCurve, u: Array) -> Array:
    """Length along the curve from its start to each u, shape (n,) [m]; u holds every knot."""
    return np.concatenate([[0.0], np.cumsum(curve.lengths(u))])


def follow(
    model: Model,
    orientation: Orientation,
    rotation: RotationLaw,
    branch: int,
    q_start: Array,
    tolerance: float = 5e-6,
    axis_tolerance: float = 2e-4,
) -> Followed:
    """The joint path of one branch whose TCP stays within `tolerance` [m] and `axis_tolerance` [rad] of the curve.

    Raises:
        UnreachableError: the branch ends, or jumps, somewhere between the stations.
    """
    curve = orientation.curve
    u = station_parameters(curve, COARSE)
    for _ in range(MAX_ROUNDS):
        s = arc_length(curve, u)
        q = _configurations(model, orientation, u, rotation(s), branch, q_start)
        path = JointPath.through(s, q)
        middle = (u[:-1] + u[1:]) / 2
        s_middle = s[:-1] + curve.lengths(np.sort(np.concatenate([u, middle])))[::2]
        X = orientation.poses(middle, rotation(s_middle))
        reached = model.tcp_pose(path(s_middle))
        error = np.linalg.norm(reached[:, :3, 3] - X[:, :3, 3], axis=1)
        turned = _angle(reached[:, :3, :3] @ orientation.spindle, X[:, :3, :3] @ orientation.spindle)
        step = np.abs(np.diff(q, axis=0)).max(axis=1)
        coarse = (error > tolerance) | (turned > axis_tolerance) | (step > JOINT_STEP)
        if not coarse.any():
            return Followed(path, u, float(error.max()), float(turned.max()))
        # a spline's error spreads to the neighbours: a jump in knot distance would send it back and forth
        coarse[1:] |= coarse[:-1].copy() & (np.diff(s)[1:] > 3 * np.diff(s)[:-1])
        coarse[:-1] |= coarse[1:].copy() & (np.diff(s)[:-1] > 3 * np.diff(s)[1:])
        u = np.sort(np.concatenate([u, middle[coarse]]))
    at = int(np.argmax(step))
    point = int(curve.origin[min(int(u[at]), curve.segments - 1)])
    raise UnreachableError(
        f"near point {point + 1} axis {int(np.argmax(np.abs(np.diff(q, axis=0))[at])) + 1} turns by "
        f"{np.degrees(step[at]):.1f} deg within {1e6 * np.diff(s)[at]:.1f} um of path: the path runs through a "
        "singularity; free the tool rotation, or move the work frame"
    )


def _configurations(
    model: Model, orientation: Orientation, u: Array, rotation: Array, branch: int, q_start: Array
) -> Array:
    q = model.inverse_kinematics_branches(orientation.poses(u, rotation)).q[:, branch]
    missing = ~np.isfinite(q).all(axis=1)
    if missing.any():
        curve = orientation.curve
        point = int(curve.origin[min(int(u[int(np.argmax(missing))]), curve.segments - 1)])
        raise UnreachableError(f"on the way to point {point + 1} the arm is too short; move the work frame")
    q = np.unwrap(q, axis=0)
    turns = np.round((q_start - q[0]) / (2 * np.pi))
    return np.asarray(q + 2 * np.pi * turns)


def _angle(a: Array, b: Array) -> Array:
    """Angle between unit vectors, exact for small ones [rad]."""
    return np.asarray(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=1) / 2, 0, 1)))
