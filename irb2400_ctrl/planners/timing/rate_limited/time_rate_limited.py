"""`time_rate_limited`: the fastest motion along a path whose torque, or acceleration, changes at
most at a given rate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.enclosure.cells import enclose
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits, speed_bounds
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import (
    ConstrainedOutputs,
    Integers,
)
from irb2400_ctrl.planners.timing.rate_limited.interior_point import solve
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_grid import first_grid, refined
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_program import RateLimitedProgram
from irb2400_ctrl.planners.timing.rate_limited.sampled_check import sampled_ratios
from irb2400_ctrl.planners.timing.time_joint_path import FeedBound, time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.torque_constraints import ROUNDING

Array = npt.NDArray[np.float64]

# how often what the bounds show above a limit is held back; then the motion is slowed by what is
# left of it
_ROUNDS = 4
_PARTS = 4
# what may be left of it: the check of the plan will say so
_UNSETTLED = 1e-3
# a ratio to a limit, at the speed that keeps all others, that slowing down does not cure
_HOPELESS = 20.0
_HELD = 2e-5
# of the first solution, which only shows where cells have to be small, and of the others; parts of
# the duration
_ROUGH = 1e-3
_GAP = 2e-4
# speed, as a part of the fastest, below which nothing is looked for
_SLOWEST = 1e-4
# barrier to start with, near a solution
_WARM = 1e-1
_NEAR = 1e-3
# channels kept in each cell once it is known which ones are close to their limits, as a part of all
_SELECTED = 0.5


@dataclass(frozen=True)
class RateLimitedTiming:
    """A time law and how it was reached."""

    law: RateLimitedLaw
    fastest: TimeLaw
    """the certified one without limits of rates"""
    iterations: int
    """of Newton's method, over all programs"""


def time_rate_limited(
    dynamics: PathDynamics,
    path: JointPath,
    limits: MotionLimits,
    *,
    count: int = 500,
    feed: FeedBound | None = None,
) -> RateLimitedTiming:
    """The time law from rest to rest, without a jump of the acceleration, whose bounds over all
    times keep the limits.

    The fastest motion with jumps says where to begin. A first program on a coarse grid shows where
    the speed changes and which channels matter; a second one, on small cells there, is solved until
    `sampled_ratios` finds nothing above a limit anywhere.

    Args:
        dynamics: the arm.
        path: the joint path.
        limits: with `torque_rate`, `jerk` or both.
        count: about how many cells to begin with.
        feed: bound of x = sdot^2 in cells, see `retime`.

    Raises:
        InputError: no limit of a rate among the limits.
        InfeasiblePointError: no motion within the limits; says where, and which axis lacks what.
    """
    if not limits.smooth:
        raise InputError(
            "limits: found neither torque_rate nor jerk, expected at least one of them"
        )
    jumping = replace(limits, torque_rate=None, jerk=None)
    fastest, cells = time_joint_path(dynamics, path, jumping, count=count, feed=feed)
    s = first_grid(
        path,
        fastest.law,
        ConstrainedOutputs.of(cells, limits, dynamics.model.robot.friction),
        count,
    )
    problem = _Problem.on(dynamics, path, limits, s, fastest.law, feed)
    found = solve(problem.program, problem.start(), gap=_ROUGH)
    iterations = found.iterations
    rough = law_of(problem.program, s, found.z)
    s = refined(rough, problem.program.channels)
    problem = _Problem.on(dynamics, path, limits, s, rough, feed)
    z = problem.start(rough)
    selected = problem.selected(rough, Certificate(path, rough, limits), dynamics)
    barrier = _WARM
    for turn in range(_ROUNDS):
        found = solve(selected.program, z, barrier=barrier, gap=_GAP)
        iterations += found.iterations
        law = law_of(problem.program, s, found.z)
        ratios, fine = sampled_ratios(Certificate(path, law, limits), dynamics, _PARTS)
        if _largest(ratios) <= 1 - ROUNDING or turn == _ROUNDS - 1:
            break
        _refuse(
            problem,
            ratios,
            fine,
            _HOPELESS,
            "which no timing cures: an effect's torque jumps there by itself",
        )
        problem = problem.holding_back(ratios[:2], fine)
        # a channel that was left out and is above its limit: all of them from now on
        selected = problem if selected.overlooks(ratios[:2], fine) else problem.like(selected)
        z = selected.inside(found.z)
        barrier = _NEAR
    for _ in range(_ROUNDS):
        worst = _largest(ratios)
        if worst <= 1 - ROUNDING or worst > _HOPELESS:
            break
        # torque falls with the square of the speed, but for gravity and friction
        law = law.slowed(1 + 0.7 * (worst - 1) + ROUNDING)
        ratios, fine = sampled_ratios(Certificate(path, law, limits), dynamics, _PARTS)
    _refuse(
        problem,
        ratios,
        fine,
        1 + _UNSETTLED,
        "and slowing down does not settle it; raise the torque rate or the jerk",
    )
    return RateLimitedTiming(law, fastest.law, iterations)


def law_of(program: RateLimitedProgram, s: Array, z: Array) -> RateLimitedLaw:
    """The time law of a program's unknowns."""
    b = program.bernstein(z)
    h = np.diff(s)[1:-1]
    x = np.concatenate([[0.0], b[:, 0], b[-1:, 2], [0.0]])
    u = np.concatenate([[0.0], (b[:, 1] - b[:, 0]) / h, [(b[-1, 2] - b[-1, 1]) / h[-1]], [0.0]])
    return RateLimitedLaw(s.copy(), x, u)


def rates_of(certificate: Certificate, dynamics: PathDynamics, fastest: TimeLaw) -> dict[str, Any]:
    """Limits and upper bounds of torque rate and jerk per axis, and the duration without them, for
    `plan.json`."""
    limits = certificate.limits
    n = dynamics.model.robot.n
    (_, rate, _), _ = sampled_ratios(certificate, dynamics, _PARTS)
    most = rate.max(axis=0)
    found: dict[str, Any] = {"duration_without_rates_s": fastest.duration}
    if limits.torque_rate is not None:
        found["torque_rate_limit_Nm_s"] = _listed(limits.torque_rate)
        found["max_torque_rate_Nm_s"] = _listed(limits.torque_rate, most[:n])
    if limits.jerk is not None:
        ratio = np.zeros(n)
        ratio[np.isfinite(limits.qdd_max) | np.isfinite(limits.jerk)] = most[n:]
        found["jerk_limit_deg_s3"] = _listed(np.degrees(limits.jerk))
        found["max_jerk_deg_s3"] = _listed(np.degrees(limits.jerk), ratio)
    return found


def _listed(limits: Array, ratio: Array | None = None) -> list[float | None]:
    """Numbers per axis, limits times ratio; None where there is no limit."""
    part = np.ones_like(limits) if ratio is None else ratio
    return [float(f * v) if np.isfinite(v) else None for f, v in zip(part, limits, strict=True)]


def _refuse(
    problem: _Problem, ratios: tuple[Array, ...], fine: Array, most: float, why: str
) -> None:
    """Raise InfeasiblePointError where a ratio is larger than `most`."""
    worst = _known(np.maximum(*ratios[:2]))
    if worst.max() > most:
        place, channel = np.unravel_index(int(np.argmax(worst)), worst.shape)
        channels = problem.program.channels
        names = (
            ("torque", "torque rate")
            if np.isfinite(channels.friction[3, 0, channel])
            else ("acceleration", "jerk")
        )
        kind = names[int(ratios[1][place, channel] > ratios[0][place, channel])]
        axis = channels.axis[0, channel]
        raise InfeasiblePointError(
            float(fine[place]),
            f", the {kind} of axis {axis} is {worst.max():.3g} times its limit, {why}",
        )


def _largest(ratios: tuple[Array, ...]) -> float:
    return max(float(_known(r).max()) for r in ratios)


def _known(ratio: Array) -> Array:
    """A bound that could not be computed holds nothing."""
    return np.where(np.isnan(ratio), np.inf, ratio)


@dataclass(frozen=True)
class _Problem:
    """A grid and the program on it."""

    s: Array
    program: RateLimitedProgram
    columns: Integers
    """which channel each of the program's is, shape (m, k)"""

    @classmethod
    def on(
        cls,
        dynamics: PathDynamics,
        path: JointPath,
        limits: MotionLimits,
        s: Array,
        near: TimeLaw | RateLimitedLaw,
        feed: FeedBound | None,
    ) -> _Problem:
        """The program on a grid, near a motion that is known."""
        cells = enclose(dynamics, path, s)
        channels = ConstrainedOutputs.of(cells, limits, dynamics.model.robot.friction)
        bound = np.minimum(
            speed_bounds(cells, limits.qd_max, None if feed is None else feed(s)), 1e9
        )
        x = near.on(s)[0] if isinstance(near, RateLimitedLaw) else np.interp(s, near.s, near.x)
        guess = np.minimum(x, bound)
        keep = np.ones_like(channels.limit)
        columns = np.broadcast_to(np.arange(channels.count), keep.shape)
        return cls(s, RateLimitedProgram(channels, bound, guess, (keep, keep)), columns)

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
            if self.program.slacks(z).min() > 0:
                return slower * z
        raise self._stuck(z)

    def _stuck(self, z: Array) -> InfeasiblePointError:
        """Which limit stays out of reach, and where."""
        channels = self.program.channels
        rows, _ = self.program.rows(z, slopes=False)
        cell, row = np.unravel_index(int(np.argmin(rows)), rows.shape)
        place = int(cell) + 1
        channel = int(row) % channels.count
        axis = channels.axis[place, channel]
        rate = channels.rate[place, channel]
        if row < 6 * channels.count:
            limit = channels.limit[place, channel]
            return InfeasiblePointError(
                float(self.s[place]),
                f", axis {axis} is over its limit even in slow motion: the arm and static friction "
                "need "
                f"{(1 - rows[cell, row]) * limit:,.0f} of {limit:,.0f} Nm; lighten the load, or "
                "raise torque_Nm",
            )
        torque = np.isfinite(channels.friction[3, place, channel])
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

    def holding_back(self, ratios: tuple[Array, ...], fine: Array) -> _Problem:
        """The same with a little more than what is above the limits held back, in the cells where
        it is."""
        keep = []
        for kept, ratio in zip(self.program.keep, self._coarse(ratios, fine), strict=True):
            keep.append(kept / np.where(ratio > 1 - ROUNDING, ratio * (1 + _HELD), 1.0))
        return replace(self, program=replace(self.program, keep=(keep[0], keep[1])))

    def _coarse(self, ratios: tuple[Array, ...], fine: Array) -> list[Array]:
        """The largest ratios among the parts of each cell, shapes (m, k) of all channels."""
        at = np.clip(np.searchsorted(self.s, (fine[:-1] + fine[1:]) / 2) - 1, 0, len(self.s) - 2)
        found = []
        for ratio in ratios:
            most = np.zeros((len(self.s) - 1, ratio.shape[1]))
            np.maximum.at(most, at, ratio)
            found.append(most)
        return found

    def selected(
        self, law: RateLimitedLaw, certificate: Certificate, dynamics: PathDynamics
    ) -> _Problem:
        """The same with only those channels in each cell that were the closest to their limits in a
        motion nearby."""
        k = self.program.channels.count
        few = int(np.ceil(_SELECTED * k))
        ratios, fine = sampled_ratios(certificate, dynamics, 1)
        close = np.maximum(*ratios[:2])
        # and in the cells around
        padded = np.pad(close, ((3, 3), (0, 0)), mode="edge")
        close = np.lib.stride_tricks.sliding_window_view(padded, 7, axis=0).max(axis=-1)
        middle = (self.s[:-1] + self.s[1:]) / 2
        here = close[np.clip(np.searchsorted(fine, middle) - 1, 0, len(close) - 1)]
        return self._with(np.sort(np.argsort(-here, axis=1)[:, :few], axis=1))

    def like(self, other: _Problem) -> _Problem:
        """The same with another problem's selection."""
        return self._with(other.columns)

    def _with(self, columns: Integers) -> _Problem:
        keep = tuple(np.take_along_axis(k, columns, 1) for k in self.program.keep)
        channels = self.program.channels.selected(columns)
        return _Problem(
            self.s, replace(self.program, channels=channels, keep=(keep[0], keep[1])), columns
        )

    def overlooks(self, ratios: tuple[Array, ...], fine: Array) -> bool:
        """Whether a channel that is not selected is above its limit."""
        chosen = np.zeros((len(self.s) - 1, ratios[0].shape[1]), dtype=bool)
        np.put_along_axis(chosen, self.columns, True, 1)
        return any(bool(((most > 1) & ~chosen).any()) for most in self._coarse(ratios, fine))
