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
        """All that the arm may reach, from its foot up to twice the height of axis 2."""
        g = model.arm_geometry
        reach = abs(g.a1) + g.a2 + g.forearm_reach()
        foot = g.X_B0[:3, 3]
        low = np.array([foot[0] - reach, foot[1] - reach, foot[2]])
        high = np.array([foot[0] + reach, foot[1] + reach, foot[2] + 2 * abs(g.d1)])
        return cls(low, high, turns)

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

    def pose(self, upright: Array, centre: Array) -> Array:
        """X_BW (4, 4) of a work object that stands as R_BW = `upright` (3, 3) without a turn, with
        the middle of its part at `centre` (3,) in its own frame."""
        c = np.cos(self.turn)
        s = np.sin(self.turn)
        X = np.eye(4)
        X[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ upright
        X[:3, 3] = self.middle - X[:3, :3] @ centre
        return X


def middle_of(tasks: list[Task]) -> Array:
    """Middle of the box around all way-points, in the work object's frame [m], shape (3,)."""
    points = np.concatenate([task.path.position for task in tasks])
    return np.asarray((points.min(axis=0) + points.max(axis=0)) / 2)
