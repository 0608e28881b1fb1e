"""`TimeLaw`: when a path is where, and what is sure of the motion it makes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_bounds import Checked, Peaks
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits


@dataclass(frozen=True)
class TimeLaw(ABC):
    """s(t) from rest to rest on a grid; x = sdot^2 and u = sddot stand for the motion."""

    s: Array
    """grid [m], shape (m + 1,)"""
    x: Array
    """sdot^2 at the grid points [m2/s2], shape (m + 1,)"""

    def __post_init__(self) -> None:
        for part in fields(self):
            getattr(self, part.name).setflags(write=False)

    @property
    @abstractmethod
    def time(self) -> Array:
        """When the grid points are passed [s], shape (m + 1,)."""

    @property
    def duration(self) -> float:
        """[s]; not finite where the path comes to rest on its way."""
        return float(self.time[-1])

    @property
    @abstractmethod
    def largest(self) -> Array:
        """Upper bound of sdot^2 in each cell, shape (m,)."""

    @abstractmethod
    def on(self, s: Array) -> tuple[Array, Array]:
        """x and u at lengths s, shapes of s."""

    @abstractmethod
    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """(s, sdot, sddot) at the given times; before the start and after the end the path stands
        still."""

    def motion(self, path: JointPath, time: Array) -> tuple[Array, Array, Array, Array]:
        """(s, q, qd, qdd) at the given times; shapes (k,) and (k, n)."""
        s, v, u = self.at(time)
        first = path(s, 1)
        second = path(s, 2)
        return s, path(s), first * v[:, None], second * v[:, None] ** 2 + first * u[:, None]

    @abstractmethod
    def slowed(self, factor: float) -> TimeLaw:
        """The same motion that takes `factor` times as long."""

    @abstractmethod
    def bounds(self, path: JointPath, limits: MotionLimits, dynamics: PathDynamics) -> Checked:
        """Bounds over all times from the law's own numbers; nothing of a solver is used.

        Args:
            path: the joints over the length s [m].
            limits: of torque [Nm], speed and acceleration, and of their rates.
            dynamics: the arm's torque along the path.
        """

    @abstractmethod
    def peaks(self, path: JointPath, limits: MotionLimits, dynamics: PathDynamics) -> Peaks:
        """Largest torque of each axis, and the largest torque rate, cell by cell.

        Args:
            path: the joints over the length s [m].
            limits: of torque [Nm], speed and acceleration, and of their rates.
            dynamics: the arm's torque along the path.
        """
