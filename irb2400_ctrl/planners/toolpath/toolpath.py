"""`ToolPath`: way-points of the tool centre point, as CAM or a script states them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from irb2400_ctrl.arrays import Array, are_rotations, is_pose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.typed import typed

FARTHEST = 1000.0
"""[m] from the origin of its frame, in any direction"""


@typed
@dataclass(frozen=True)
class ToolPath:
    """Way-points joined by straight lines; lines, circles and splines are built as fine polylines
    (`builders`).

    Exactly one of `axis` and `rotation` is given: with `axis` the tool may turn about it freely.
    """

    position: Array
    """TCP in the robot base [m], shape (n, 3)"""
    axis: Array | None = None
    """unit vectors from the tool tip towards the spindle, shape (n, 3)"""
    rotation: Array | None = None
    """full orientation R_BT, shape (n, 3, 3)"""
    feed: Array = field(default_factory=lambda: np.empty(0))
    """limit of the TCP speed on the way to each point, inf where none is stated [m/s], shape
    (n,)"""
    name: str = "path"

    def __repr__(self) -> str:
        held = "tool axes" if self.rotation is None else "full orientations"
        return f"<ToolPath {self.name}: {len(self.position)} points with {held}>"

    def __post_init__(self) -> None:
        n = len(self.position)
        if self.feed.size == 0:
            object.__setattr__(self, "feed", np.full(n, np.inf))
        if (self.axis is None) == (self.rotation is None):
            raise InputError(f"{self.name}: expected either tool axes or full orientations")
        if n < 2:
            raise InputError(f"{self.name}: found {n} point(s), expected at least 2")
        shapes = {"position": (n, 3), "axis": (n, 3), "rotation": (n, 3, 3), "feed": (n,)}
        for key, shape in shapes.items():
            value = getattr(self, key)
            if value is None:
                continue
            array = np.array(value, dtype=float)
            if array.shape != shape:
                raise InputError(f"{self.name}: {key} has shape {array.shape}, expected {shape}")
            if np.isnan(array).any() or (key != "feed" and not np.isfinite(array).all()):
                row = int(np.argwhere(~np.isfinite(array))[0][0])
                raise InputError(f"{self.name}: {key} of point {row + 1} is not finite")
            object.__setattr__(self, key, array)
        far = np.abs(self.position).max(axis=1) > FARTHEST
        if far.any():
            row = int(np.argmax(far))
            raise InputError(
                f"{self.name}: point {row + 1} is {np.abs(self.position[row]).max():.3g} m away, "
                f"expected at most {FARTHEST:g} m; check its numbers and their unit"
            )
        if (self.feed <= 0).any():
            row = int(np.argmax(self.feed <= 0))
            raise InputError(
                f"{self.name}: feed of point {row + 1} is {self.feed[row]}, expected a positive "
                "speed"
            )
        if self.axis is not None:
            length = np.linalg.norm(self.axis, axis=1)
            if (length < 1e-6).any():
                raise InputError(
                    f"{self.name}: the tool axis of point {int(np.argmin(length)) + 1} has no "
                    "direction"
                )
            object.__setattr__(self, "axis", self.axis / length[:, None])
        if self.rotation is not None:
            wrong = ~are_rotations(self.rotation)
            if wrong.any():
                raise InputError(
                    f"{self.name}: the orientation of point {int(np.argmax(wrong)) + 1} is not a "
                    "rotation"
                )
        for key in shapes:
            value = getattr(self, key)
            if value is not None:
                value.setflags(write=False)

    def __len__(self) -> int:
        return len(self.position)

    @typed
    def moved(self, X_BW: Array) -> ToolPath:
        """The same path stated in a work frame W, expressed in the base by X_BW (4, 4)."""
        X = np.asarray(X_BW, dtype=float)
        if not is_pose(X):
            raise InputError("work frame: expected a pose [[R, p], [0, 0, 0, 1]] of shape (4, 4)")
        R = X[:3, :3]
        p = X[:3, 3]
        return ToolPath(
            self.position @ R.T + p,
            None if self.axis is None else self.axis @ R.T,
            None if self.rotation is None else R @ self.rotation,
            self.feed,
            self.name,
        )

    def carried(self, M: Array) -> ToolPath:
        """The same with each way-point moved by its own pose M (n, 4, 4)."""
        R = M[:, :3, :3]
        return ToolPath(
            np.einsum("nij,nj->ni", R, self.position) + M[:, :3, 3],
            None if self.axis is None else np.einsum("nij,nj->ni", R, self.axis),
            None if self.rotation is None else R @ self.rotation,
            self.feed,
            self.name,
        )

    def part(self, rows: slice) -> ToolPath:
        """Some neighbouring way-points of it."""
        return ToolPath(
            self.position[rows],
            None if self.axis is None else self.axis[rows],
            None if self.rotation is None else self.rotation[rows],
            self.feed[rows],
            self.name,
        )

    def tool_axis(self, spindle_axis: Array) -> Array:
        """Unit vectors from the tip towards the spindle, shape (n, 3); the spindle points out along
        `spindle_axis`."""
        if self.axis is not None:
            return self.axis
        assert self.rotation is not None
        return -self.rotation @ spindle_axis
