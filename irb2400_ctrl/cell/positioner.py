"""A two-axis positioner that holds the work-piece: its angles stand still while the robot machines
(3+2), or move with it (`external_axes`).

W is the work-piece on the positioner's plate, P the plate's foot: X_BW = X_BP A_1(q_1) A_2(q_2)
X_2W, each axis a line in P at zero angles (product of exponentials).
"""

from __future__ import annotations

from typing import Annotated, Literal, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field, model_validator

from irb2400_ctrl.arrays import Array, is_pose, rotations_about
from irb2400_ctrl.cell.external_axes import TABLE as AXES
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.numbers import Positive, Vector3
from irb2400_ctrl.table import Table

Row4 = tuple[float, float, float, float]
Pose = tuple[Row4, Row4, Row4, Row4]
Angles = tuple[float, float]
_IDENTITY: Pose = (
    (1.0, 0.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0, 0.0),
    (0.0, 0.0, 0.0, 1.0),
)


class _Moved(Protocol):
    def moved(self, X: Array) -> Self:
        """The same at another pose."""
        ...


Movable = TypeVar("Movable", bound=_Moved)


class PositionerAxis(Table):
    """One turning axis at zero angles, in the positioner's own frame."""

    direction: Vector3
    point_m: Vector3
    range_deg: tuple[float, float]

    @model_validator(mode="after")
    def _usable(self) -> Self:
        if np.linalg.norm(self.direction) < 1e-9:
            raise ValueError("direction has no length")
        if self.range_deg[0] > self.range_deg[1]:
            raise ValueError(f"range_deg is {list(self.range_deg)}, expected the lower end first")
        return self

    def motion(self, angle: float) -> Array:
        """Turn by `angle` [rad] about the axis, shape (4, 4)."""
        k = np.array(self.direction) / np.linalg.norm(self.direction)
        X = np.eye(4)
        X[:3, :3] = rotations_about(k, angle)
        X[:3, 3] = (np.eye(3) - X[:3, :3]) @ np.array(self.point_m)
        return X


class Positioner(Table):
    """Two axes one on the other: `tilt` on the floor, `turn` carried by it, the work-piece on
    `turn`."""

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
            if not is_pose(np.array(getattr(self, key))):
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
            name = AXES[axis]
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

    def in_robot_base(self, path: Movable, angles: ArrayLike) -> Movable:
        """A path stated on the work-piece, in the robot base with the positioner at (tilt, turn)
        [rad]."""
        return path.moved(self.work_piece_pose(angles))


class PlateAxis(Table):
    """An axis of a positioner in a cell file, at zero angles."""

    direction: Vector3
    """in the robot base, right-handed; its length says nothing"""
    point_mm: Vector3
    """any place on the axis, in the robot base"""
    range_deg: Angles
    """lower and upper end; equal for an axis that does not turn"""
    speed_deg_s: Positive | None = None
    acceleration_deg_s2: Positive | None = None
    jerk_deg_s3: Positive | None = None
    """limits of an axis that turns during the cut; of the jerk, where it has one"""

    @property
    def axis(self) -> PositionerAxis:
        """The same in metres."""
        x, y, z = self.point_mm
        return PositionerAxis(
            direction=self.direction,
            point_m=(x / 1e3, y / 1e3, z / 1e3),
            range_deg=self.range_deg,
        )


_LEVEL = PlateAxis(direction=(0.0, 1.0, 0.0), point_mm=(0.0, 0.0, 0.0), range_deg=(0.0, 0.0))


class Plate(Table):
    """A positioner in a cell file: it turns the work object, and all that stands in its frame."""

    tilt: PlateAxis = _LEVEL
    """a table without it does not tilt"""
    turn: PlateAxis
    """carried by `tilt`"""
    position_deg: Angles | Literal["find", "move"] = (0.0, 0.0)
    """(tilt, turn) while the arm works; "find": for each operation the angles at which its tool
    axes are nearest to upright; "move": both axes turn during the cut"""
    operations: dict[str, Angles | Literal["find", "move"]] = Field(default_factory=dict)
    """for an operation of this name, or number"""
    keep: Vector3 | None = None
    """direction in the robot base that a positioner which moves keeps the tool near, out of the
    part; default up, against gravity"""

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for name, axis in zip(AXES, (self.tilt, self.turn), strict=True):
            try:
                _ = axis.axis
            except ValueError as error:
                raise ValueError(f"{name}: {error}") from error
        asked = [self.position_deg, *self.operations.values()]
        for angles in asked:
            if isinstance(angles, tuple):
                self.moved(angles)
        if "move" in asked:
            _ = self.moving
        if self.keep is not None and not any(self.keep):
            raise ValueError("keep: found no direction, expected one such as [0, 0, 1]")
        return self

    @property
    def moving(self) -> ExternalAxes:
        """Both axes as they turn during the cut.

        Raises:
            ValueError: an axis that turns has no limits of speed and acceleration.
        """
        axes = (self.tilt, self.turn)
        for name, axis in zip(AXES, axes, strict=True):
            turns = axis.range_deg[0] < axis.range_deg[1]
            if turns and (axis.speed_deg_s is None or axis.acceleration_deg_s2 is None):
                raise ValueError(
                    f"{name} has no speed_deg_s or no acceleration_deg_s2, expected both of an "
                    'axis that turns during the cut ("move")'
                )
        # an axis that stands has limits, too, so that they can be divided by
        limits = [
            (axis.speed_deg_s or 1.0, axis.acceleration_deg_s2 or 1.0, axis.jerk_deg_s3 or np.inf)
            for axis in axes
        ]
        speed, acceleration, jerk = np.radians(limits).T
        direction = np.array([axis.direction for axis in axes], dtype=float)
        ranges = self.kinematics.ranges
        return ExternalAxes(
            names=AXES,
            direction=direction / np.linalg.norm(direction, axis=1, keepdims=True),
            point=np.array([axis.point_mm for axis in axes]) / 1e3,
            low=ranges[0],
            high=ranges[1],
            speed=speed,
            acceleration=acceleration,
            jerk=jerk,
        )

    @property
    def kinematics(self) -> Positioner:
        """Its two axes, the work object at the robot base."""
        return Positioner(
            source="the cell file", base=_IDENTITY, tilt=self.tilt.axis, turn=self.turn.axis
        )

    def moved(self, angles_deg: Angles) -> Array:
        """What it does to a pose in the robot base at (tilt, turn) [deg], shape (4, 4)."""
        try:
            return self.kinematics.work_piece_pose(np.radians(angles_deg))
        except InputError as error:
            raise ValueError(str(error)) from error

    def asked(self, number: int, name: str) -> Angles | Literal["find", "move"]:
        """What the file states for an operation."""
        found = self.operations.get(name, self.operations.get(str(number)))
        return self.position_deg if found is None else found
