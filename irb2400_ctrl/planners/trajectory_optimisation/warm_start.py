"""Where an optimisation starts: a motion through the way-points, its certified timing, and its
knots."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_move import JointMove
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_timing import time_with_samples
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.trajectory_optimisation.knots import Knots
from irb2400_ctrl.planners.trajectory_optimisation.optimised import MotionOutcome, outcome
from irb2400_ctrl.trajectory import Trajectory

Start = JointPath | JointMove | Trajectory | Certificate

# the warm start is slowed by this before the solver sees it: a point well inside the limits
_SLOWED = 1.3
_LEAST = 8
_PASSED = 1e-6


def warm_start(
    dynamics: PathDynamics, limits: MotionLimits, W: Array, start: Start | None
) -> tuple[Certificate | Knots, Array, MotionOutcome | None]:
    """A motion to begin with, when it passes the way-points, and its certified version if it has
    one."""
    if isinstance(start, JointMove):
        start = start.trajectory
    if isinstance(start, Trajectory):
        start = clamped(start.time, start.q)
    path = start.path if isinstance(start, Certificate) else start
    if path is None:
        path = JointPath.through(np.linspace(0.0, 1.0, len(W)), W)
        s = np.linspace(0.0, 1.0, len(W))
        exact = True
    else:
        s, exact = _passed(path, W)
    try:
        certificate = Certificate(path, time_again(dynamics, path, limits), limits)
    except InfeasibleError:
        # no timing: straight from way-point to way-point, slowly, is a guess all the same
        at = np.concatenate(
            [[0.0], np.cumsum(2 * (np.abs(np.diff(W, axis=0)) / limits.qd_max).max(axis=1) + 0.2)]
        )
        return Knots(at, W, np.zeros_like(W), np.zeros_like(W)), at, None
    at = np.interp(s, certificate.law.s, certificate.law.time)
    at[[0, -1]] = 0.0, certificate.law.duration
    return certificate, at, outcome(certificate, dynamics) if exact else None


def _passed(path: JointPath, W: Array) -> tuple[Array, bool]:
    """Where a path passes the way-points, and whether it does so exactly."""
    fine = np.unique(np.concatenate([path.knots, np.linspace(path.knots[0], path.knots[-1], 4001)]))
    q = path(fine)
    s = []
    first = 0
    for k, w in enumerate(W):
        distance = np.abs(q[first:] - w).max(axis=1)
        first += 0 if k == 0 else len(distance) - 1 if k == len(W) - 1 else int(np.argmin(distance))
        at = np.array([fine[first]])
        for _ in range(3):
            slope = path(at, 1)[0]
            gap = w - path(at)[0]
            at = np.clip(
                at + slope @ gap / max(float(slope @ slope), 1e-12), path.knots[0], path.knots[-1]
            )
        s.append(float(at[0]))
    s[0] = float(path.knots[0])
    s[-1] = float(path.knots[-1])
    error = np.abs(path(np.array(s)) - W).max(axis=1)
    if error.max() > 0.1 or not (np.diff(s) > 0).all():
        raise InputError(
            f"start passes way-point {int(np.argmax(error)) + 1} at a distance of "
            f"{np.degrees(error.max()):.1f} deg, "
            "or not in order; expected a path through all of them"
        )
    return np.array(s), bool(error.max() < _PASSED)


def shares(at: Array, intervals: int) -> tuple[int, ...]:
    """Even numbers of intervals in proportion to the durations of the segments."""
    share = np.diff(at) / (at[-1] - at[0])
    return tuple(2 * int(v) for v in np.maximum(_LEAST // 2, np.round(intervals / 2 * share)))


def knots_of(
    guess: Certificate | Knots, at: Array, counts: tuple[int, ...], longest: float
) -> Knots:
    """The warm start at the knots of the transcription, slowed."""
    times = [np.linspace(a, b, k + 1)[1:] for a, b, k in zip(at[:-1], at[1:], counts, strict=True)]
    t = np.concatenate([[0.0], *times])
    if isinstance(guess, Knots):
        q = np.stack([np.interp(t, guess.time, column) for column in guess.q.T], axis=1)
        return Knots(t, q, np.zeros_like(q), np.zeros_like(q))
    slow = float(np.clip(longest / at[-1], 1.0, _SLOWED))
    _, q, qd, qdd = guess.law.motion(guess.path, t)
    qd[[0, -1]] = 0.0
    return Knots(slow * t, q, qd / slow, qdd / slow**2)


def clamped(t: Array, q: Array) -> JointPath:
    """The spline through knots in time that starts and ends at rest; its parameter is the time."""
    from scipy.interpolate import CubicSpline

    return JointPath(
        np.array(t), np.ascontiguousarray(CubicSpline(t, q, bc_type="clamped").c[::-1])
    )


def time_again(dynamics: PathDynamics, path: JointPath, limits: MotionLimits) -> TimeLaw:
    """The fastest certified time law of a geometry.

    Raises:
        InfeasibleError: there is none.
    """
    law, cells = time_joint_path(dynamics, path, limits)
    if dynamics.irregular:
        open_feed = np.full(len(cells.h), np.inf)
        law = time_with_samples(
            dynamics, path, cells, limits, dynamics.model.robot.friction, open_feed
        )
    return law
