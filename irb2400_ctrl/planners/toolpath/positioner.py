"""A two-axis positioner that holds the work-piece, used 3+2: its angles stand still while the robot
machines.

W is the work-piece on the positioner's plate, P the plate's foot: X_BW = X_BP A_1(q_1) A_2(q_2)
X_2W, each axis a line in P at zero angles (product of exponentials).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
from numpy.typing import ArrayLike
from pydantic import BaseModel, ConfigDict, Field, model_validator

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

Vector3 = tuple[float, float, float]
Row4 = tuple[float, float, float, float]
Pose = tuple[Row4, Row4, Row4, Row4]
_IDENTITY: Pose = (
    (1.0, 0.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0, 0.0),
    (0.0, 0.0, 0.0, 1.0),
)


class PositionerAxis(BaseModel):
    """One turning axis at zero angles, in the positioner's own frame."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    direction: Vector3
    point_m: Vector3
    range_deg: tuple[float, float]

    @model_validator(mode="after")
    def _usable(self) -> Self:
        if np.linalg.norm(self.direction) < 1e-9:
            raise ValueError("direction has no length")
        if self.range_deg[0] >= self.range_deg[1]:
            raise ValueError(f"range_deg is {list(self.range_deg)}, expected the lower end first")
        return self

    def motion(self, angle: float) -> Array:
        """Turn by `angle` [rad] about the axis, shape (4, 4)."""
        k = np.array(self.direction) / np.linalg.norm(self.direction)
        K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
        X = np.eye(4)
        X[:3, :3] += np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        X[:3, 3] = (np.eye(3) - X[:3, :3]) @ np.array(self.point_m)
        return X


class Positioner(BaseModel):
    """Two axes one on the other: `tilt` on the floor, `turn` carried by it, the work-piece on
    `turn`."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: str = "positioner"
    source: Annotated[str, Field(min_length=1)]
    base: Pose
    """X_BP, the positioner in the robot base"""
    tilt: PositionerAxis
    turn: PositionerAxis
    work_piece: Pose = _IDENTITY
    """X_PW at zero angles"""

    @model_validator(mode="after")
    def _poses(self) -> Self:
        for key in ("base", "work_piece"):
            X = np.array(getattr(self, key))
            R = X[:3, :3]
            if (
                np.abs(R @ R.T - np.eye(3)).max() > 1e-6
                or np.linalg.det(R) < 0
                or (X[3] != (0, 0, 0, 1)).any()
            ):
                raise ValueError(f"{key} is not a pose: expected [[R, p], [0, 0, 0, 1]]")
        return self

    @property
    def ranges(self) -> Array:
        """Lower and upper angles of tilt and turn [rad], shape (2, 2)."""
        return np.radians([self.tilt.range_deg, self.turn.range_deg]).T

    def work_piece_pose(self, angles: ArrayLike) -> Array:
        """X_BW at (tilt, turn) [rad], shape (4, 4).

        Raises:
            InputError: not two finite angles inside the ranges.
        """
        q = np.asarray(angles, dtype=float)
        if q.shape != (2,) or not np.isfinite(q).all():
            raise InputError(
                f"{self.name}: found angles {angles!r}, expected two finite ones (tilt, turn)"
            )
        low, high = self.ranges
        if (q < low - 1e-9).any() or (q > high + 1e-9).any():
            axis = int(np.argmax(np.maximum(low - q, q - high)))
            name = ("tilt", "turn")[axis]
            limits = np.degrees([low[axis], high[axis]])
            raise InputError(
                f"{self.name}: {name} at {np.degrees(q[axis]):.2f} deg, range {limits[0]:.0f} to "
                f"{limits[1]:.0f} deg"
            )
        X: Array = (
            np.array(self.base)
            @ self.tilt.motion(q[0])
            @ self.turn.motion(q[1])
            @ np.array(self.work_piece)
        )
        return X

    def in_robot_base(self, path: ToolPath, angles: ArrayLike) -> ToolPath:
        """A path stated on the work-piece, in the robot base with the positioner at (tilt, turn)
        [rad]."""
        return path.moved(self.work_piece_pose(angles))


@dataclass(frozen=True)
class Setting:
    """A stretch of a path machined at one position of the positioner."""

    first: int
    """first way-point"""
    last: int
    """last way-point, the first one of the next stretch"""
    angles: tuple[float, float]
    """(tilt, turn) [rad]"""
    worst_tilt: float
    """largest angle between tool axis and the favourable direction on the stretch [rad]"""


def choose_settings(
    positioner: Positioner,
    path: ToolPath,
    *,
    spindle_axis: ArrayLike = (0.0, 0.0, 1.0),
    favourable: ArrayLike = (0.0, 0.0, 1.0),
    largest_tilt: float = np.radians(30.0),
    step: float = np.radians(5.0),
) -> list[Setting]:
    """The fewest settings such that the tool axis stays within `largest_tilt` of a favourable
    direction.

    Each stretch goes on as long as some angles (of a grid) keep it within the bound; of these the
    ones with the smallest largest tilt are taken. Part of a feasible stretch is feasible, so greedy
    stretches are the fewest that the grid allows.

    Args:
        path: stated on the work-piece.
        spindle_axis: of the tool, for a path of full orientations.
        favourable: direction from tip to spindle that suits the robot, in its base; default
            upright.
        largest_tilt: at most 90 degrees, so that moves between two way-points stay within it as
            well [rad].
        step: of the grid of angles [rad].

    Raises:
        InfeasibleError: a way-point or a move between two that no angles bring within the bound;
        says which.
    """
    wanted = np.asarray(favourable, dtype=float)
    if wanted.shape != (3,) or not np.isfinite(wanted).all() or np.linalg.norm(wanted) < 1e-9:
        raise InputError(f"favourable direction is {favourable!r}, expected a vector of length 3")
    if not 0 < step <= np.pi / 2 or not 0 < largest_tilt <= np.pi / 2:
        raise InputError("expected a step and a largest tilt of more than 0 and at most 90 deg")
    axes = path.tool_axis(np.asarray(spindle_axis, dtype=float))
    low, high = positioner.ranges
    tilts, turns = (
        np.linspace(a, b, int(np.ceil((b - a) / step)) + 1) for a, b in zip(low, high, strict=True)
    )
    grid = np.array([(tilt, turn) for tilt in tilts for turn in turns])
    R = np.array([positioner.work_piece_pose(angles)[:3, :3] for angles in grid])
    # the favourable direction as the work-piece sees it at every setting of the grid
    seen = np.einsum("gji,j->gi", R, wanted / np.linalg.norm(wanted))
    bound = float(np.cos(largest_tilt)) - 1e-12
    settings: list[Setting] = []
    first = 0
    while first < len(path) - 1:
        last, cosine = _stretch(seen, axes, first, bound)
        if last == first:
            raise InfeasibleError(f"{positioner.name}: {_why(seen, axes, first, largest_tilt)}")
        # of equally good angles those nearest to zero
        good = np.flatnonzero(cosine >= cosine.max() - 1e-9)
        best = int(good[np.argmin(np.abs(grid[good]).sum(axis=1))])
        angles = (float(grid[best, 0]), float(grid[best, 1]))
        settings.append(
            Setting(first, last, angles, float(np.arccos(np.clip(cosine[best], -1.0, 1.0))))
        )
        first = last
    return settings


def _stretch(seen: Array, axes: Array, first: int, bound: float) -> tuple[int, Array]:
    """The furthest way-point that one setting reaches from `first`, and the smallest cosine at
    every setting (g,)."""
    cosine = seen @ axes[first]
    last = first
    for k in range(first + 1, len(axes)):
        with_next = np.minimum(cosine, seen @ axes[k])
        if with_next.max() < bound:
            break
        cosine = with_next
        last = k
    return last, cosine


def _why(seen: Array, axes: Array, first: int, largest_tilt: float) -> str:
    """What keeps the move from `first` to the next way-point from any setting."""
    for k in (first, first + 1):
        nearest = float(np.degrees(np.arccos(np.clip((seen @ axes[k]).max(), -1.0, 1.0))))
        if nearest > np.degrees(largest_tilt):
            return (
                f"the tool axis of point {k + 1} comes no nearer than {nearest:.1f} deg to the "
                "favourable direction, "
                f"expected {np.degrees(largest_tilt):.1f}; try wider ranges or a larger tilt"
            )
    turn = float(np.degrees(np.arccos(np.clip(axes[first] @ axes[first + 1], -1.0, 1.0))))
    return (
        f"no one setting holds the move from point {first + 1} to point {first + 2}, which turns "
        "the tool axis by "
        f"{turn:.1f} deg; split the path there or allow a larger tilt than "
        f"{np.degrees(largest_tilt):.1f} deg"
    )
