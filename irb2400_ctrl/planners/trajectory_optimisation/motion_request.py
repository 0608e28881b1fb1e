"""`MotionRequest`: what a motion with free geometry has to keep, and what a motion found lacks of
it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers, positive
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, path_dynamics
from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.trajectory_optimisation.knot_coupling import Objective
from irb2400_ctrl.planners.trajectory_optimisation.knots import Knots
from irb2400_ctrl.planners.trajectory_optimisation.optimised import MotionOutcome, outcome
from irb2400_ctrl.planners.trajectory_optimisation.retiming import (
    slowed_outcome,
    smooth_outcome,
    smooth_path,
)
from irb2400_ctrl.planners.trajectory_optimisation.warm_start import clamped, time_again
from irb2400_ctrl.planners.trajectory_optimisation.waypoints import (
    checked_waypoints,
    signed_margins,
)
from irb2400_ctrl.robot import Robot

# of the torque limits in a second: an axis without a limit of its own
_UNLIMITED = 1e4


def _finite(rate: Array, tau_max: Array) -> Array:
    """Torque rates, with a large one for axes that have no limit."""
    return np.asarray(np.where(np.isfinite(rate), rate, _UNLIMITED * tau_max))


@dataclass(frozen=True)
class MotionRequest:
    """What is asked for, checked."""

    dynamics: PathDynamics
    limits: MotionLimits
    waypoints: Array
    objective: Objective
    longest: float
    margins: tuple[tuple[int, float], ...]
    torque_rate: Array | None

    @classmethod
    def of(
        cls,
        robot: Robot,
        waypoints: ArrayLike,
        objective: Objective,
        duration: float | None,
        margins: Mapping[str, float] | None,
        torque_rate: ArrayLike | None,
        limits: MotionLimits | None,
    ) -> MotionRequest:
        """The request of a caller.

        Raises:
            InputError: way-points, margins, torque rate or duration that cannot be.
        """
        dynamics = path_dynamics(robot)
        W = checked_waypoints(dynamics.model, waypoints)
        bounds = signed_margins(dynamics.model, W, margins or {})
        rate = None
        if torque_rate is not None:
            rate = numbers("torque_rate", torque_rate)
            wrong = rate.shape not in {(), (robot.n,)} or not np.isfinite(rate).all()
            if wrong or not (rate > 0).all():
                raise InputError(
                    f"torque_rate is {rate.tolist()}, expected one positive number of Nm/s per axis"
                )
            rate = np.broadcast_to(rate, (robot.n,))
        if duration is not None:
            positive("duration", duration, "s")
        longest = np.inf if duration is None else duration
        stated = MotionLimits.of(robot) if limits is None else limits
        own = None if stated.torque_rate is None else _finite(stated.torque_rate, stated.tau_max)
        if own is not None:
            rate = own if rate is None else np.minimum(rate, own)
        return cls(dynamics, stated, W, objective, longest, bounds, rate)

    @property
    def smooth(self) -> bool:
        """Whether the geometry is timed again with a limited torque rate."""
        return self.objective == "time" and self.torque_rate is not None

    def timed(self, knots: Knots) -> MotionOutcome:
        """The optimised geometry timed again: the fastest way, or with the solver's own law where
        energy counts.

        Raises:
            InfeasibleError: there is no timing within the limits.
        """
        if self.smooth and self.torque_rate is not None:
            return smooth_outcome(self.dynamics, smooth_path(knots), self.limits, self.torque_rate)
        path = clamped(knots.time, knots.q)
        if self.objective == "energy":
            return slowed_outcome(self.dynamics, path, self.limits, self.torque_rate)
        law = time_again(self.dynamics, path, self.limits)
        return outcome(Certificate(path, law, self.limits), self.dynamics)

    def missed(self, found: MotionOutcome) -> str | None:
        """What a motion lacks, in words; None where it has everything."""
        robot = self.dynamics.model.robot
        path = found.certificate.path
        if not found.checked.holds():
            torque = found.checked.torque_ratio
            speed = found.checked.velocity_ratio
            return f"torque at {torque:.4f}, speed at {speed:.4f} of their limits"
        if found.duration > self.longest * (1 + 1e-9):
            return f"{found.duration:.3f} s are longer than {self.longest:.3f} s"
        # the extremes of a cubic spline are at its knots and reversals
        q = path(np.concatenate([path.knots, path.reversals()]))
        excess = np.maximum(robot.q_min - q, q - robot.q_max).max(axis=0)
        if excess.max() > 1e-9:
            return (
                f"axis {int(np.argmax(excess)) + 1} leaves its range by "
                f"{np.degrees(excess.max()):.2f} deg"
            )
        if robot.coupling.difference_deg is not None:
            low, high = np.radians(robot.coupling.difference_deg)
            cubics = path.coefficients[:, :, 2] - path.coefficients[:, :, 1]
            enclosed = bernstein.from_powers(cubics, np.diff(path.knots))
            if enclosed.min() < low - 1e-7 or enclosed.max() > high + 1e-7:
                return "q3 - q2 leaves its range"
        for k, bound in self.margins:
            if found.margins[NAMES[k]] < abs(bound) * (1 - 1e-9):
                return (
                    f"the {NAMES[k]} margin is {found.margins[NAMES[k]]:.4g}, expected "
                    f"{abs(bound):.4g}"
                )
        if (
            self.torque_rate is not None
            and (found.torque_rate > self.torque_rate * (1 + 1e-6)).any()
        ):
            axis = int(np.argmax(found.torque_rate / self.torque_rate))
            return f"the torque of axis {axis + 1} changes by {found.torque_rate[axis]:,.0f} Nm/s"
        return None

    def cost(self, found: MotionOutcome) -> float:
        """The objective."""
        return found.duration if self.objective == "time" else float(found.energy.sum())
