"""From the curve of the tool to joint angles: closed form at stations, a spline between them,
stations where needed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve

# distance between stations to start with [m]
COARSE = 0.02
# a joint that moves further between stations is looked at more closely [rad]
JOINT_STEP = 0.15
MAX_ROUNDS = 40
# stations are not put closer than this: a joint that still jumps there has no path [m]
SMALLEST = 1e-10
# a joint that turns by more than JUMP [rad] within so little of the path [m] jumps
JUMP = 0.5
JUMP_WITHIN = 1e-7
# below this the wrist is so straight that q4 has no direction of its own [-]
STRAIGHT = 1e-6
# a joint that moves by less than this is at rest: its friction would follow the sign of rounding
# [rad]
RESTS = 1e-9


@dataclass(frozen=True)
class JointTarget:
    """What the joints have to follow along a curve."""

    orientation: Orientation
    pose: Callable[[Array, Array], Array]
    """X_BT (n, 4, 4) at curve parameters u and lengths s, both (n,)"""
    branch: Callable[[Array], Integers]
    """closed-form branch at curve parameters u"""

    @classmethod
    def of(
        cls, orientation: Orientation, rotation: Callable[[Array], Array], branch: int
    ) -> JointTarget:
        """One branch, the tool turned by rotation(s) [rad] about the spindle."""
        return cls(
            orientation,
            lambda u, s: orientation.poses(u, rotation(s)),
            lambda u: np.full(len(u), branch, dtype=np.int64),
        )

    @property
    def curve(self) -> TaskCurve:
        """The curve of the tool."""
        return self.orientation.curve

    def point(self, u: float) -> int:
        """Number 1… of the way-point that leads on from u."""
        curve = self.curve
        return int(curve.origin[min(int(u), curve.segments - 1)]) + 1


@dataclass(frozen=True)
class Followed:
    """A joint path and how it belongs to the curve of the tool."""

    joints: JointPath
    """of the arm and, where such move, of the axes that carry the part"""
    u: Array
    """curve parameter at the knots of the joint path, shape (m + 1,)"""
    error: float
    """largest distance of the TCP from its target, between stations [m]"""
    axis_error: float
    """largest angle of the tool axis to its target, between stations [rad]"""


def station_parameters(curve: TaskCurve, spacing: float) -> Array:
    """Curve parameters at every knot and, on long segments, in between so that `spacing` [m] is
    kept."""
    knots = np.arange(curve.segments + 1.0)
    count = np.maximum(1, np.ceil(curve.lengths(knots) / spacing).astype(int))
    return divided(knots, count)


def arc_length(curve: TaskCurve, u: Array) -> Array:
    """Length along the curve from its start to any sorted u, shape (n,) [m]."""
    every = np.unique(np.concatenate([u, np.arange(curve.segments + 1.0)]))
    total = np.concatenate([[0.0], np.cumsum(curve.lengths(every))])
    return np.asarray(total[np.searchsorted(every, u)])


def follow(
    model: Model,
    target: JointTarget,
    q_start: Array | None,
    tolerance: float = 5e-6,
    axis_tolerance: float = 2e-4,
) -> Followed:
    """The joint path whose TCP stays within `tolerance` [m] and `axis_tolerance` [rad] of the
    target.

    Args:
        model: the arm.
        target: poses and branch along the curve.
        q_start: configuration at the start, decides the whole turns [rad]; None takes those that
            fit the joint box.
        tolerance, axis_tolerance: how exactly the target is followed between stations.

    Raises:
        UnreachableError: the branch ends, or jumps, somewhere between the stations.
    """
    curve = target.curve
    u = station_parameters(curve, COARSE)
    dropped = np.empty(0)
    # a path that asks for more stations than this has a jump in it
    most = 4 * len(u) + 3000
    for _ in range(MAX_ROUNDS):
        s = arc_length(curve, u)
        q, kept = _configurations(model, target, u, s, q_start)
        dropped = np.concatenate([dropped, u[~kept]])
        u = u[kept]
        s = s[kept]
        _no_jump(model, target, u, q)
        q = np.hstack([q, target.orientation.external(u)])
        path = JointPath.through(s, _resting(q))
        middle = (u[:-1] + u[1:]) / 2
        s_middle = arc_length(curve, np.sort(np.concatenate([u, middle])))[1::2]
        error, turned = _missed(model, target, middle, s_middle, path(s_middle))
        step = np.abs(np.diff(q, axis=0)).max(axis=1)
        coarse = (error > tolerance) | (turned > axis_tolerance) | (step > JOINT_STEP)
        if not coarse.any():
            return Followed(path, u, float(error.max()), float(turned.max()))
        # a spline's error spreads to the neighbours: a jump in knot distance would send it back and
        # forth
        gaps = np.diff(s)
        coarse[1:] |= coarse[:-1].copy() & (gaps[1:] > 3 * gaps[:-1])
        coarse[:-1] |= coarse[1:].copy() & (gaps[:-1] > 3 * gaps[1:])
        jumps = (step > JUMP) & (gaps < JUMP_WITHIN)
        if jumps.any() or (gaps[coarse] < SMALLEST).any() or len(u) > most:
            break
        # a station that was dropped comes back beside its old place
        beside = np.isin(middle, dropped) * (u[1:] - u[:-1]) / 6
        u = np.sort(np.concatenate([u, (middle + beside)[coarse]]))
    at = int(np.argmax(step))
    raise _jump(target, u[at], np.diff(q, axis=0)[at], float(np.diff(s)[at]))


def _missed(model: Model, target: JointTarget, u: Array, s: Array, q: Array) -> tuple[Array, Array]:
    """How far TCP [m] and tool axis [rad] are from their target, in the eyes of the part, with
    the joints and further axes at q (m, n); each (m,)."""
    X = target.pose(u, s)
    reached = model.tcp_pose(q[:, : model.robot.n])
    part = target.orientation.part
    if part is not None:
        X = part.axes.seen(part.law(u), X)
        reached = part.axes.seen(q[:, model.robot.n :], reached)
    spindle = target.orientation.spindle
    error = np.linalg.norm(reached[:, :3, 3] - X[:, :3, 3], axis=1)
    return error, _angle(reached[:, :3, :3] @ spindle, X[:, :3, :3] @ spindle)


def _resting(q: Array) -> Array:
    """The same with joints that only move by rounding held where they are."""
    return np.where(np.ptp(q, axis=0) < RESTS, q[:1], q)


def _no_jump(model: Model, target: JointTarget, u: Array, q: Array) -> None:
    """Refuse a path on which a joint jumps: a large step between stations that stays however
    closely one looks.

    Looking at the largest step alone finds out within a few rounds what new stations along the
    whole path, which a spline needs to follow a jump, would find out at a hundred times the cost.
    """
    step = np.abs(np.diff(q, axis=0)).max(axis=1)
    at = int(np.argmax(step))
    low = u[at]
    high = u[at + 1]
    for _ in range(MAX_ROUNDS):
        if step[at] <= JUMP:
            return
        fine = np.linspace(low, high, 33)
        s = arc_length(target.curve, fine)
        X = target.pose(fine, s)
        found = model.inverse_kinematics_branches(X).q[np.arange(len(fine)), target.branch(fine)]
        clear = np.isfinite(found).all(axis=1) & (_bent(model, found))
        if clear.sum() < 2:
            return
        fine = fine[clear]
        s = s[clear]
        found = np.unwrap(found[clear], axis=0)
        change = np.diff(found, axis=0)
        step = np.abs(change).max(axis=1)
        at = int(np.argmax(step))
        low = fine[at]
        high = fine[at + 1]
        if step[at] > JUMP and s[at + 1] - s[at] < JUMP_WITHIN:
            raise _jump(target, low, change[at], float(s[at + 1] - s[at]))


def _bent(model: Model, q: Array) -> npt.NDArray[np.bool_]:
    """Whether the wrist has a direction of its own, |sin phi5| >= STRAIGHT; shape (n,)."""
    phi5 = model.arm_geometry.canonical(q)[:, 4]
    return np.asarray(np.abs(np.sin(phi5)) >= STRAIGHT)


def _jump(target: JointTarget, u: float, change: Array, way: float) -> UnreachableError:
    axis = int(np.argmax(np.abs(change)))
    # the way-point next to it, not the one that follows
    point = target.point(round(u) - 0.5) if u > 0.5 else 1
    return UnreachableError(
        f"near point {point} axis {axis + 1} turns by {np.degrees(abs(change[axis])):.1f} deg "
        "within "
        f"{1e6 * way:.3g} um of path: the path runs through a singularity; "
        "free the tool rotation, or move the work frame"
    )


def _configurations(
    model: Model, target: JointTarget, u: Array, s: Array, q_start: Array | None
) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Continuous joint angles at the stations that have them, and which stations these are."""
    X = target.pose(u, s)
    branch = target.branch(u)
    q = model.inverse_kinematics_branches(X).q[np.arange(len(u)), branch]
    missing = ~np.isfinite(q).all(axis=1)
    if missing.any():
        point = target.point(u[int(np.argmax(missing))])
        raise UnreachableError(
            f"on the way to point {point} the arm is too short; move the work frame"
        )
    straight = ~_bent(model, q)
    if straight.all():
        straight[:] = False
    # at an end q4 comes from the neighbours' direction; in between the spline passes through by
    # itself
    for end, near in (
        (0, np.flatnonzero(~straight)[:1]),
        (len(u) - 1, np.flatnonzero(~straight)[-1:]),
    ):
        if straight[end] and len(near):
            q[end] = model.inverse_kinematics_branches(X[end : end + 1], q[near[0]]).q[
                0, branch[end]
            ]
    straight[[0, -1]] = False
    q = np.unwrap(q[~straight], axis=0)
    return q + 2 * np.pi * _turns(model, q, q_start), ~straight


def _turns(model: Model, q: Array, q_start: Array | None) -> Array:
    """Whole turns to add: those of the start, or those that bring the motion to the middle of the
    joint box."""
    if q_start is not None:
        return np.asarray(np.round((q_start - q[0]) / (2 * np.pi)))
    centre = (model.robot.q_min + model.robot.q_max) / 2
    return np.asarray(np.round((centre - (q.min(axis=0) + q.max(axis=0)) / 2) / (2 * np.pi)))


def _angle(a: Array, b: Array) -> Array:
    """Angle between unit vectors, exact for small ones [rad]."""
    return np.asarray(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=1) / 2, 0, 1)))
