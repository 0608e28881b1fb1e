"""How far a motion is from the stated way-points, and from the singularities, over the whole path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.ball import ball_function
from irb2400_ctrl.planners.cells import parabolas
from irb2400_ctrl.planners.follow import Followed
from irb2400_ctrl.planners.orientation import Orientation
from irb2400_ctrl.planners.task_curve import ROTATION_LENGTH, TaskCurve

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Deviation:
    """Largest distances between the motion and the polygon of way-points."""

    position: Array
    """distance of the TCP from the polygon at `s` [m]"""
    axis: Array
    """angle between the tool axis and the one stated there [rad]"""
    s: Array
    corner: float
    """largest distance of a way-point from the motion [m]"""

    @property
    def largest(self) -> float:
        """Both ways: motion from polygon, way-point from motion [m]."""
        return max(float(self.position.max()), self.corner)


def deviation(model: Model, orientation: Orientation, followed: Followed) -> Deviation:
    """Distances at every station and three times in between."""
    curve = orientation.curve
    path, joints = curve.path, followed.joints
    f = np.array([0.0, 0.25, 0.5, 0.75])
    s = np.append((joints.knots[:-1, None] + f * np.diff(joints.knots)[:, None]).ravel(), joints.knots[-1])
    u = np.append((followed.u[:-1, None] + f * np.diff(followed.u)[:, None]).ravel(), followed.u[-1])
    X = model.tcp_pose(joints(s))
    p, axis = X[:, :3, 3], -(X[:, :3, :3] @ orientation.spindle)
    stated = path.tool_axis(orientation.spindle)
    both, stated_both = (np.hstack([x, ROTATION_LENGTH * y]) for x, y in ((p, axis), (path.position, stated)))
    point = curve.origin[np.minimum(u.astype(int), curve.segments - 1)]
    distance, angle, nearest = (np.full(len(s), np.inf) for _ in range(3))
    for shift in (-1, 0, 1):
        last = np.clip(point + shift, 1, len(path) - 1)
        d, _ = _to_segment(p, path.position[last - 1], path.position[last])
        # the place by position and direction together, so that turning on the spot has a place, too
        gap, t = _to_segment(both, stated_both[last - 1], stated_both[last])
        between = stated[last - 1] + t[:, None] * (stated[last] - stated[last - 1])
        between /= np.maximum(np.linalg.norm(between, axis=1, keepdims=True), 1e-12)
        a = 2 * np.arcsin(np.clip(np.linalg.norm(axis - between, axis=1) / 2, 0, 1))
        angle = np.where(gap < nearest, a, angle)
        distance, nearest = np.minimum(d, distance), np.minimum(gap, nearest)
    return Deviation(distance, angle, s, _corners(curve) + followed.error)


def _corners(curve: TaskCurve) -> float:
    """Largest distance of a way-point from the curve: looked for one segment before and behind its control point."""
    last = np.flatnonzero(np.append(np.diff(curve.origin) > 0, True))
    point, at = curve.path.position[curve.origin[last]], last + 1.0
    looks = np.linspace(-1.0, 1.0, 33)
    u = np.clip(at[:, None] + looks, 0.0, float(curve.segments))
    places = curve(u.ravel())[:, :3].reshape(*u.shape, 3)
    best = np.full(len(point), np.inf)
    for k in range(len(looks) - 1):
        d, _ = _to_segment(point, places[:, k], places[:, k + 1])
        best = np.minimum(best, d)
    return float(best.max())


def _to_segment(p: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """Distance of points from segments and the foot's parameter 0…1."""
    side = b - a
    length2 = np.maximum((side**2).sum(axis=1), 1e-30)
    t = np.clip(((p - a) * side).sum(axis=1) / length2, 0, 1)
    return np.linalg.norm(p - a - t[:, None] * side, axis=1), t


def singularity_margins(model: Model, followed: Followed) -> dict[str, float]:
    """Lower bounds of |sin q5| [-], |r| [m] and |k| [m] (eqs. 34-36) that hold at every point of the path."""
    factors = model.function("singularity_factors")
    value, radius = compile_function(factors), compile_function(ball_function(factors))
    coefficients, remainder = parabolas(
        followed.joints,
        followed.joints.knots,
        lambda q, dq, ddq: value.map(q),
        lambda q, dq, ddq, r, dr, ddr: radius.map(q, r),
    )
    bernstein, rest = coefficients[0], remainder[0]
    one_sign = (bernstein > 0).all(axis=1) | (bernstein < 0).all(axis=1)
    lower = np.where(one_sign, np.abs(bernstein).min(axis=1) - rest, 0.0)
    smallest = np.maximum(lower.min(axis=0), 0.0)
    return dict(zip(("wrist", "shoulder", "elbow"), map(float, smallest), strict=True))
