"""What else could be done about a wrist singularity, and its price in millimetres, degrees and
seconds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, less_turns
from irb2400_ctrl.errors import InfeasibleError, UnreachableError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.joint_box import outside_box
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.redundancy.choice import Choice
from irb2400_ctrl.planners.redundancy.choices import choices
from irb2400_ctrl.planners.redundancy.follow import Followed, arc_length, station_parameters
from irb2400_ctrl.planners.redundancy.wrist_passage import EXACT
from irb2400_ctrl.planners.toolpath.orientation import Orientation

# damping grows from nothing to this as sin q5 falls from the second number to zero
_DAMPING = 0.05
_DAMPED_BELOW = 0.1


@dataclass(frozen=True)
class Remedy:
    """One way to deal with the passages of a path and what it costs."""

    name: str
    duration: float
    """[s]; inf where it leads nowhere"""
    position: float
    """largest distance of the TCP from the stated path [m]"""
    angle: float
    """largest angle between the tool and the stated orientation [rad]"""
    allowed: bool

    def summary(self) -> dict[str, Any]:
        """For `plan.json`."""
        return {
            "remedy": self.name,
            "duration_s": self.duration if np.isfinite(self.duration) else None,
            "position_mm": 1e3 * self.position,
            "angle_deg": float(np.degrees(self.angle)),
            "allowed": self.allowed,
        }


def of_choice(choice: Choice, duration: float, tolerance: float) -> Remedy | None:
    """The remedy that a timed choice stands for; None when its path has no passage of the wrist."""
    passing = choice.passing
    if passing is None or not passing.passages:
        return None
    turned = passing.turn
    if turned >= EXACT:
        name = "leave the orientation and pass through"
    elif any(passing.through):
        name = "pass exactly through"
    else:
        name = "slow down"
    return Remedy(name, duration, choice.followed.error, turned, bool(turned <= tolerance))


def taken(choice: Choice) -> list[dict[str, Any]]:
    """What the chosen path does at each passage, for `plan.json`."""
    if choice.passing is None:
        return []
    words = {True: "through", False: "past"}
    return [
        {"at_mm": 1e3 * p.s, "miss_deg": float(np.degrees(p.miss)), "taken": words[t]}
        for p, t in zip(choice.passing.passages, choice.passing.through, strict=True)
    ]


def turned_about_axis(model: Model, orientation: Orientation) -> list[tuple[Choice, float]]:
    """Choices with the rotation about the tool axis freed, and the largest rotation away from the
    stated one [rad]."""
    try:
        found = list(choices(model, orientation, free=True, keep=1))
    except UnreachableError:
        return []
    options = []
    for choice in found:
        angle = choice.rotation(choice.followed.joints.knots)
        options.append((choice, float(np.abs(less_turns(angle)).max())))
    return options


def damped(model: Model, orientation: Orientation, start: Followed) -> Followed:
    """Damped least squares along the path from the start of a followed one.

    dq = J^T (J J^T + lambda^2 1)^-1 dx, lambda = 0.05 (1 - |sin q5| / 0.1) below |sin q5| = 0.1.

    Raises:
        InfeasibleError: the joints run away.
    """
    curve = orientation.curve
    u = np.unique(np.concatenate([station_parameters(curve, 0.002), start.u]))
    s = arc_length(curve, u)
    X = orientation.poses(u, np.zeros(1))
    q = start.joints(s[:1])[0, : model.robot.n]
    rows = [q]
    position = 0.0
    angle = 0.0
    for target in X[1:]:
        for _ in range(3):
            J = model.tcp_jacobian(q)
            pose = model.tcp_pose(q)
            error = np.concatenate(
                [target[:3, 3] - pose[:3, 3], _rotation_vector(target[:3, :3] @ pose[:3, :3].T)]
            )
            phi5 = model.arm_geometry.canonical(q)[4]
            weight = _DAMPING * max(0.0, 1 - abs(np.sin(phi5)) / _DAMPED_BELOW)
            q = q + J.T @ np.linalg.solve(J @ J.T + weight**2 * np.eye(6), error)
        pose = model.tcp_pose(q)
        position = max(position, float(np.linalg.norm(target[:3, 3] - pose[:3, 3])))
        angle = max(angle, float(np.linalg.norm(_rotation_vector(target[:3, :3] @ pose[:3, :3].T))))
        rows.append(q)
    path = np.array(rows)
    if not np.isfinite(path).all() or outside_box(model, path) is not None:
        raise InfeasibleError("damped least squares leaves the joint box")
    path = np.hstack([path, orientation.external(u)])
    return Followed(JointPath.through(s, path), u, position, angle)


def _rotation_vector(R: Array) -> Array:
    """Axis times sine of the angle: a small rotation's vector, shape (3,)."""
    return np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
