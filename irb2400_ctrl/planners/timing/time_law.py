"""`TimeLaw`: when the path is where; sddot is constant between grid points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.joint_path import JointPath

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TimeLaw:
    """s(t) with sdot^2 = x linear in s between the grid points."""

    s: Array
    """grid [m], shape (m + 1,)"""
    x: Array
    """sdot^2 at the grid points [m2/s2], shape (m + 1,)"""

    def __post_init__(self) -> None:
        self.s.setflags(write=False)
        self.x.setflags(write=False)

    @cached_property
    def u(self) -> Array:
        """sddot in each cell [m/s2], shape (m,)."""
        return np.asarray(np.diff(self.x) / (2 * np.diff(self.s)))

    @property
    def largest(self) -> Array:
        """Largest sdot^2 in each cell, shape (m,)."""
        return np.maximum(self.x[:-1], self.x[1:])

    @cached_property
    def time(self) -> Array:
        """When the grid points are passed [s], shape (m + 1,)."""
        v = np.sqrt(self.x)
        with np.errstate(divide="ignore"):
            step = 2 * np.diff(self.s) / (v[:-1] + v[1:])
        return np.concatenate([[0.0], np.cumsum(step)])

    @property
    def duration(self) -> float:
        """[s]; not finite when the path gets stuck."""
        return float(self.time[-1])

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """(s, sdot, sddot) at the given times; before the start and after the end the path stands
        still."""
        inside = np.clip(time, 0.0, self.duration)
        cell = np.clip(np.searchsorted(self.time, inside, side="right") - 1, 0, len(self.u) - 1)
        dt = inside - self.time[cell]
        v = np.sqrt(self.x[cell])
        u = self.u[cell]
        s = np.minimum(self.s[cell] + dt * (v + dt * u / 2), self.s[cell + 1])
        speed = np.maximum(v + dt * u, 0.0)
        over = (time >= self.duration) | (time < 0)
        return s, np.where(over, 0.0, speed), np.where(over, 0.0, u)

    def motion(self, path: JointPath, time: Array) -> tuple[Array, Array, Array, Array]:
        """(s, q, qd, qdd) at the given times; shapes (k,) and (k, n)."""
        s, v, u = self.at(time)
        first = path(s, 1)
        second = path(s, 2)
        return s, path(s), first * v[:, None], second * v[:, None] ** 2 + first * u[:, None]
