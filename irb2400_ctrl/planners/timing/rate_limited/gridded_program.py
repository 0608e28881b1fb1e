"""`GriddedProgram`: a `RateLimitedProgram` on a grid of one path, and how a motion changes it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.cells import enclose
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits, speed_bounds
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import ConstrainedOutputs
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import OutputRatios
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_program import RateLimitedProgram
from irb2400_ctrl.planners.timing.time_joint_path import FeedBound
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.torque_constraints import ROUNDING

# held back beyond what is above a limit, as a part of it
_HELD = 2e-5
# and of what is above it, up to the second number: its rows are elsewhere in the next motion
_AHEAD = 0.3
_LITTLE = 0.05
# speed, as a part of the fastest, below which nothing is looked for
_SLOWEST = 1e-4


@dataclass(frozen=True)
class GriddedProgram:
    """A grid and the program on it."""

    s: Array
    program: RateLimitedProgram

    @classmethod
    def on(
        cls,
        dynamics: PathDynamics,
        path: JointPath,
        limits: MotionLimits,
        s: Array,
        near: TimeLaw,
        feed: FeedBound | None,
    ) -> GriddedProgram:
        """The program on a grid, near a motion that is known."""
        cells = enclose(dynamics, path, s)
        outputs = ConstrainedOutputs.of(cells, limits, dynamics.friction)
        # x is no straight line here: the smaller end holds all over a cell
        feed_bound = None if feed is None else np.atleast_2d(feed(s)).min(axis=0)
        bound = np.minimum(speed_bounds(cells, limits.qd_max, feed_bound), 1e9)
        guess = np.minimum(near.on(s)[0], bound)
        keep = np.ones_like(outputs.limit)
        return cls(s, RateLimitedProgram(outputs, bound, guess, (keep, keep)))

    def start(self, near: RateLimitedLaw | None = None) -> Array:
        """Unknowns of a smooth motion, or of about the one the program was made near to, slowed
        until it is inside."""
        x = self.program.reference
        if near is None:
            z = (x[1:-2] + x[2:-1]) / 2
        else:
            # the same spline on more cells: its middle Bernstein coefficients are the control
            # points
            x, u = near.on(self.s)
            z = (x + np.append(np.diff(self.s), 0.0) * u)[1:-2]
            # where the speed falls steeply these may lie below zero: on the chord they do not
            z = np.where(z > 0, z, (x[1:-2] + x[2:-1]) / 2)
        z[0] = x[1]
        z[-1] = x[-2]
        return self.inside(z, 0.8 if near is None else 0.98)

    def inside(self, z: Array, slower: float = 0.98) -> Array:
        """The same motion slowed until it is within all limits, with some room.

        Raises:
            InfeasiblePointError: it is not within them however slow.
        """
        least = _SLOWEST**2 * z.max()
        while z.max() > least:
            z = slower * z
            if self.program.slacks(z)[1] > -np.inf:
                return slower * z
        raise self._out_of_reach(z)

    def _out_of_reach(self, z: Array) -> InfeasiblePointError:
        """Which limit stays out of reach, and where."""
        outputs = self.program.outputs
        place, row, slack = self.program.worst(z)
        output = min(row // 12, outputs.count - 1)
        axis = outputs.axis[place, output]
        rate = outputs.rate[place, output]
        if row % 12 < 6:
            limit = outputs.limit[place, output]
            return InfeasiblePointError(
                float(self.s[place]),
                f", axis {axis} is over its limit even in slow motion: the arm and static friction "
                "need "
                f"{(1 - slack) * limit:,.0f} of {limit:,.0f} Nm; lighten the load, or "
                "raise torque_Nm (or the torque share, if it is below 1)",
            )
        torque = np.isfinite(outputs.friction[3, place, output])
        limited = (
            f"torque rate of {rate:,.3g} Nm/s"
            if torque
            else f"jerk of {np.degrees(rate):,.3g} deg/s3"
        )
        return InfeasiblePointError(
            float(self.s[place]),
            f", axis {axis} would have to be slower than {_SLOWEST:g} of the fastest motion to "
            f"keep its {limited}; "
            "raise it",
        )

    def holding_back(self, ratios: OutputRatios, law: RateLimitedLaw) -> GriddedProgram:
        """The same with a little more than what is above the limits held back, in the cells where
        it is: of torque, acceleration and rates their limits, of speeds the speed of the motion
        that has them."""
        keep = []
        *held, speed = self._by_cell(ratios)
        for kept, ratio in zip(self.program.keep, held, strict=True):
            too_much = np.where(ratio > 1 - ROUNDING, _held(ratio), 1.0)
            keep.append(kept / too_much)
        most = speed.max(axis=1)
        at_points = np.maximum(np.append(most, 0.0), np.insert(most, 0, 0.0))
        slower = law.on(self.s)[0] / _held(at_points) ** 2
        fast = at_points > 1 - ROUNDING
        fast[[0, -1]] = False
        bound = np.where(fast, np.minimum(self.program.bound, slower), self.program.bound)
        return replace(self, program=replace(self.program, keep=(keep[0], keep[1]), bound=bound))

    def _by_cell(self, ratios: OutputRatios) -> list[Array]:
        """The largest ratios of values, rates (m, k) and speeds (m, j) among the parts of each
        cell."""
        middle = (ratios.s[:-1] + ratios.s[1:]) / 2
        cell = np.clip(np.searchsorted(self.s, middle) - 1, 0, len(self.s) - 2)
        found = []
        for ratio in (ratios.value, ratios.rate, ratios.speed):
            most = np.zeros((len(self.s) - 1, ratio.shape[1]))
            np.maximum.at(most, cell, ratio)
            found.append(most)
        return found

    def law(self, z: Array) -> RateLimitedLaw:
        """The time law of the unknowns."""
        b = self.program.spline.bernstein(z)
        h = np.diff(self.s)[1:-1]
        last = (b[-1, 2] - b[-1, 1]) / h[-1]
        x = np.concatenate([[0.0], b[:, 0], b[-1:, 2], [0.0]])
        u = np.concatenate([[0.0], (b[:, 1] - b[:, 0]) / h, [last], [0.0]])
        return RateLimitedLaw(self.s.copy(), x, u)


def _held(ratio: Array) -> Array:
    """By how much to hold back what is above its limit."""
    return ratio * (1 + _HELD) + _AHEAD * np.clip(ratio - 1, 0.0, _LITTLE)
