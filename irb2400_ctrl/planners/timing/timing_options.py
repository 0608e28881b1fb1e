"""`TimingOptions`: the limits of a motion, and which back-end times it how finely."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from numpy.typing import ArrayLike

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.robot import Robot

Backend = Literal["certified", "toppra"]


@dataclass(frozen=True)
class TimingOptions:
    """How tool paths are timed."""

    backend: Backend
    """"certified" (torque bound at every instant) or "toppra" """
    cells: int
    """smallest number of grid cells"""
    limits: MotionLimits

    @classmethod
    def of(
        cls,
        robot: Robot,
        backend: Backend,
        cells: int,
        limits: MotionLimits | None,
        torque_rate: ArrayLike | None,
        jerk: ArrayLike | None,
    ) -> TimingOptions:
        """The options of a request; limits default to those of the robot.

        Raises:
            InputError: an unknown back-end, a limit that is not positive, or one of torque rate or
            jerk that the back-end does not know.
        """
        if backend not in {"certified", "toppra"}:
            raise InputError(f"timing: found {backend!r}, expected 'certified' or 'toppra'")
        stated = MotionLimits.of(robot) if limits is None else limits
        limited = stated.with_rates(torque_rate, jerk)
        if limited.smooth and backend != "certified":
            raise InputError(
                f"timing: found {backend!r} with a limit of torque rate or jerk, expected "
                "'certified'"
            )
        return cls(backend, cells, limited)

    @property
    def certified(self) -> bool:
        """Whether the torque is bounded between grid points."""
        return self.backend == "certified"
