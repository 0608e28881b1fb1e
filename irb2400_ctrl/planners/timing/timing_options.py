"""`TimingOptions`: the limits of a motion, and which back-end times it how finely."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.extras import needed
from irb2400_ctrl.given import whole
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
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
    sampling: Sampling
    torque_share: float = 1.0
    """part of the torque limits that is used"""
    rates_stated: bool = False
    """whether somebody asked for limits of torque rate or jerk; otherwise they are those that rows
    can follow"""

    @classmethod
    def of(
        cls,
        robot: Robot,
        backend: Backend,
        cells: int,
        limits: MotionLimits | None,
        torque_rate: ArrayLike | None,
        jerk: ArrayLike | None,
        sampling: Sampling,
        torque_share: float = 1.0,
        external: ExternalAxes | None = None,
    ) -> TimingOptions:
        """The options of a request; limits default to those of the robot.

        The torque changes at most as fast as rows of the trajectory can follow
        (`Sampling.torque_rate`), unless a torque rate is stated; inf lets it jump.

        Raises:
            InputError: an unknown back-end, a limit that is not positive or wider than the robot's,
            or one of torque rate or jerk that the back-end does not know.
            ToolMissingError: toppra is asked for, but not installed.
        """
        if not 0 < torque_share <= 1:
            raise InputError(
                f"torque share: found {torque_share}, expected more than 0 and at most 1 (0.9 is "
                "90 %)"
            )
        whole("cells", cells, 1)
        if backend not in {"certified", "toppra"}:
            raise InputError(f"timing: found {backend!r}, expected 'certified' or 'toppra'")
        if backend == "toppra":
            needed("toppra", "toppra", 'timing="toppra"')
        own = MotionLimits.of(robot)
        stated = own if limits is None else limits.within(own)
        stated = replace(stated, tau_max=torque_share * stated.tau_max)
        # what the robot file states holds beside what is asked for
        limited = stated.with_rates(torque_rate, jerk).no_faster(own.torque_rate, None)
        rates_stated = limited.smooth
        if rates_stated and backend != "certified":
            raise InputError(
                f"timing: found {backend!r} with a limit of torque rate or jerk (asked for, or "
                "torque_rate_Nm_s of the robot file), expected 'certified'"
            )
        if backend == "certified":
            limited = _for_rows(limited, own, sampling, torque_rate)
        if external is not None:
            if backend != "certified":
                raise InputError(
                    f"timing: found {backend!r} with a positioner or a carriage that moves, "
                    "expected 'certified'"
                )
            rate = sampling.torque_rate if torque_rate is None else None
            limited = limited.with_external(external, rate)
            rates_stated = rates_stated or bool(np.isfinite(external.jerk).any())
        return cls(backend, cells, limited, sampling, torque_share, rates_stated)

    @property
    def certified(self) -> bool:
        """Whether the torque is bounded between grid points."""
        return self.backend == "certified"


def _for_rows(
    limits: MotionLimits, own: MotionLimits, sampling: Sampling, torque_rate: ArrayLike | None
) -> MotionLimits:
    """The limits with the rates that rows can follow, of torques and of accelerations that have a
    limit, unless the torque may jump.

    Args:
        limits: with the rates that are stated.
        own: of the robot.
        sampling: rows of the trajectory.
        torque_rate: that was asked for [Nm/s]; inf lets the torque jump.
    """
    if torque_rate is not None and not np.isfinite(torque_rate).any():
        return limits
    rate = sampling.torque_rate
    jerk = rate * limits.qdd_max if np.isfinite(limits.qdd_max).any() else None
    return limits.no_faster(
        rate * own.tau_max if torque_rate is None else None, jerk if limits.jerk is None else None
    )
