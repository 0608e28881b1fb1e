"""`Area`: the places at which a part may stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.placement.task import Task


@dataclass(frozen=True)
class Area:
    """A box that the middle of the part stays in, and its turns about the vertical."""

    low: Array
    """least x, y, z in the base [m], shape (3,)"""
    high: Array
    """largest [m], shape (3,)"""
    turns: Array
    """angles to begin with [rad], shape (k,)"""
    turning: bool = True
    """whether angles between them may be taken, too"""

    def __post_init__(self) -> None:
        if not (self.low <= self.high).all() or not np.isfinite([self.low, self.high]).all():
            found = ", ".join(f"{1e3 * v:g}" for v in (*self.low, *self.high))
            raise InputError(
                f"area: found {found}, expected XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX in mm, none above "
                "its own end, such as 500,-800,200,1200,800,600"
            )

    @classmethod
    def around(cls, model: Model, turns: Array) -> Area:
        """All that the arm may reach across axis 1, from its foot up to twice the height of axis
        2 along it."""
        g = model.arm_geometry
        along = g.X_B0[:3, 2]
        across = np.sqrt(np.maximum(1 - along**2, 0.0))
        reach = (abs(g.a1) + g.a2 + g.forearm_reach()) * across
        foot = g.X_B0[:3, 3]
        ends = np.array([foot, foot + 2 * g.d1 * along])
        return cls(ends.min(axis=0) - reach, ends.max(axis=0) + reach, turns)

    def grid(self, spacing: float) -> Array:
        """Places (m, 3), at most `spacing` apart [m], ends included."""
        lines = [
            np.linspace(a, b, int(np.ceil((b - a) / spacing - 1e-9)) + 1)
            for a, b in zip(self.low, self.high, strict=True)
        ]
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)

    def holds(self, place: Array) -> bool:
        """Whether the middle of the part may be there."""
        return bool((place >= self.low - 1e-9).all() and (place <= self.high + 1e-9).all())


@dataclass(frozen=True)
class Standing:
    """A part as it stands: its middle, and how far it is turned."""

    middle: Array
    """in the base [m], shape (3,)"""
    turn: float
    """about the vertical, beyond how it stood at first [rad]"""

    def pose(self, R_BW: Array, centre: Array, R_UB: Array) -> Array:
        """X_BW of the work object, shape (4, 4).

        Args:
            R_BW: how it stands without a turn, shape (3, 3).
            centre: middle of its part in its own frame [m], shape (3,).
            R_UB: `upright` of the robot: its z axis is the vertical, shape (3, 3).
        """
        c = np.cos(self.turn)
        s = np.sin(self.turn)
        X = np.eye(4)
        X[:3, :3] = R_UB.T @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ R_UB @ R_BW
        X[:3, 3] = self.middle - X[:3, :3] @ centre
        return X


def middle_of(tasks: list[Task]) -> Array:
    """Middle of the box around all way-points, in the work object's frame [m], shape (3,)."""
    points = np.concatenate([task.path.position for task in tasks])
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)
