"""Full tool orientations along a task curve, up to the free rotation about the tool axis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, norms, rotations_about
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.planners.toolpath.task_curve import TaskCurve, smooth_curve
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot.capsule_fit import half_sphere


@dataclass(frozen=True, eq=False)
class PartMotion:
    """How further axes carry the part while the tool goes along its curve."""

    axes: ExternalAxes
    law: Callable[[Array], Array]
    """curve parameters (m,) -> angles of the axes (m, k) [rad]"""


@dataclass(frozen=True)
class Orientation:
    """Where tool rotation zero is: a fixed smooth field of frames on the sphere of tool axes.

    For a path of tool axes the frame at rotation zero has the TCP's first direction across the
    spindle as close to `guide` as the axis allows; for a path with full orientations it is the
    stated one.
    """

    curve: TaskCurve
    spindle: Array
    """direction of the tool in the TCP frame, out of the spindle, shape (3,)"""
    guide: Array
    """fixed direction in the base, shape (3,)"""
    part: PartMotion | None = None
    """where axes turn the part; the curve is stated with them at zero"""

    @classmethod
    def of(cls, curve: TaskCurve, spindle: Array, part: PartMotion | None = None) -> Orientation:
        """The field whose guide direction stays farthest from being parallel to a tool axis of the
        path.

        Args:
            curve: the path and its tool axes.
            spindle: axis of the spindle in the tool's frame, shape (3,).
            part: how the part moves, if it does.
        """
        spindle = np.asarray(spindle, dtype=float) / np.linalg.norm(spindle)
        axes = curve.control[:, 3:6]
        axes = axes / np.maximum(np.linalg.norm(axes, axis=1, keepdims=True), 1e-12)
        if part is not None:
            u = np.arange(curve.segments + 1.0)
            turned = part.axes.turned(part.law(u))[:, :3, :3]
            axes = np.einsum("mij,mj->mi", turned, curve.pose(u)[1])
        candidates = np.vstack([np.eye(3), half_sphere(60)])
        across = np.array([norms(np.cross(axes, other)).min() for other in candidates])
        # base x, then y, then z unless the axes come near: a guide that a user can remember
        good = np.flatnonzero(across > 0.5)
        guide = candidates[good[0] if len(good) else int(np.argmax(across))]
        return cls(curve, spindle, guide, part)

    @property
    def carried(self) -> ExternalAxes | None:
        """What carries the part; None where it stands."""
        return None if self.part is None else self.part.axes

    def external(self, u: Array) -> Array:
        """Angles of the axes that carry the part [rad], shape (n, k); k = 0 where it stands."""
        return np.empty((len(u), 0)) if self.part is None else self.part.law(u)

    def poses(self, u: Array, rotation: Array) -> Array:
        """X_BT at the curve's parameters u with the tool turned by `rotation` [rad] about the
        spindle, (n, 4, 4)."""
        X = self._at_zero(u)
        X[:, :3, :3] = X[:, :3, :3] @ rotations_about(
            self.spindle, np.broadcast_to(rotation, u.shape)
        )
        return X

    def fan(self, u: Array, rotation: Array) -> Array:
        """X_BT for all pairs of parameter and rotation, shape (len(u), len(rotation), 4, 4)."""
        X = self._at_zero(u)
        turned = np.tile(X[:, None], (1, len(rotation), 1, 1))
        turned[:, :, :3, :3] = X[:, None, :3, :3] @ rotations_about(self.spindle, rotation)[None]
        return turned

    def _at_zero(self, u: Array) -> Array:
        position, first, full = self.curve.pose(u)
        if self.part is not None:
            M = self.part.axes.turned(self.part.law(u))
            R = M[:, :3, :3]
            position = np.einsum("mij,mj->mi", R, position) + M[:, :3, 3]
            first = np.einsum("mij,mj->mi", R, first)
            full = None if full is None else R @ full
        X = np.tile(np.eye(4), (len(u), 1, 1))
        X[:, :3, 3] = position
        if full is not None:
            X[:, :3, :3] = full
            return X
        # out of the spindle is -axis; the guide's part across it is the first direction
        out = -first
        x = self.guide - (out @ self.guide)[:, None] * out
        x /= np.linalg.norm(x, axis=1, keepdims=True)
        field = np.stack([x, np.cross(out, x), out], axis=2)
        # columns (x, y, out) in the base of the tool's own (e1, e2, spindle)
        own = frame_of(self.spindle)
        X[:, :3, :3] = field @ own.T
        return X


def frame_of(z: Array) -> Array:
    """Rotation whose third column is z, first column near x (or y), shape (3, 3)."""
    helper = np.eye(3)[0] if abs(z[0]) < 0.9 else np.eye(3)[1]
    x = helper - (helper @ z) * z
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def shape_path(
    path: ToolPath, spindle: Array, tolerance: float, work_frame: Array | None = None
) -> Orientation:
    """The smooth curve of a tool path in the base, and its orientations.

    Args:
        path: way-points in the base, or in the work frame.
        spindle: direction of the tool in the TCP frame, out of the spindle, shape (3,).
        tolerance: how far corners of the polygon may be cut [m].
        work_frame: pose X_BW of the frame the path is stated in, shape (4, 4).
    """
    placed = path if work_frame is None else path.moved(work_frame)
    return Orientation.of(smooth_curve(placed, tolerance), spindle)
