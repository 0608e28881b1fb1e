"""`time_rate_limited`: the fastest motion along a path whose torque, or acceleration, changes at
most at a given rate."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import ConstrainedOutputs
from irb2400_ctrl.planners.timing.rate_limited.gridded_program import GriddedProgram
from irb2400_ctrl.planners.timing.rate_limited.interior_point import solve
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import OutputRatios
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_grid import first_grid, refined
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.sampled_reference.sampling import FeedRatios, Sampling
from irb2400_ctrl.planners.timing.time_joint_path import FeedBound, time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.torque_constraints import ROUNDING

HALVINGS = 2
"""how often cells are halved where a motion is above a limit on them"""

# how often what the bounds show above a limit is held back; then the motion is slowed by what is
# left of it
_ROUNDS = 10
# what may be left of it: the check of the plan will say so
_UNSETTLED = 1e-3
# above a limit by so little is not worth another solution: the motion is slowed by it
_ENOUGH = 5e-4
# by how much it is slowed beyond that: its rows are a little elsewhere then
_BEYOND = 1e-5
# of the duration, lost to slowing: worth so many solutions more
_LOST = 1e-3
_AGAIN = 4
# a ratio to a limit, at the speed that keeps all others, that slowing down does not cure
_HOPELESS = 20.0
# of the first solution, which only shows where cells have to be small, and of the others; parts of
# the duration
_ROUGH = 1e-3
_GAP = 2e-4
# barrier to start with, near a solution
_WARM = 1e-1
_NEAR = 1e-3
# cells to begin with, at least
_LEAST_CELLS = 150


def time_rate_limited(
    dynamics: PathDynamics,
    path: JointPath,
    limits: MotionLimits,
    *,
    count: int = 500,
    feed: FeedBound | None = None,
    sampling: Sampling | None = None,
    feed_ratios: FeedRatios | None = None,
) -> RateLimitedLaw:
    """The time law from rest to rest, without a jump of the acceleration, whose bounds over all
    times keep the limits.

    The fastest motion with jumps says where to begin. A first program on a coarse grid shows where
    the speed changes and which outputs matter; a second one, on small cells there, is solved until
    nothing is found above a limit anywhere.

    Args:
        dynamics: the arm.
        path: the joint path.
        limits: with `torque_rate`, `jerk` or both.
        count: about how many cells to begin with; fewer for a motion of fewer rows.
        feed: bound of x = sdot^2 in cells, see `FeedBound`.
        sampling: how the motion will be read; what swings above a limit of torque, speed or feed
            between rows is held back, too.
        feed_ratios: speed of the TCP over the feed in what is read, see `feed.feed_ratios`.

    Raises:
        InputError: no limit of a rate among the limits.
        InfeasiblePointError: no motion within the limits; says where, and which axis lacks what.
    """
    if not limits.smooth:
        raise InputError(
            "limits: found neither torque_rate nor jerk, expected at least one of them"
        )
    jumping = replace(limits, torque_rate=None, jerk=None)
    search = _Search(dynamics, path, limits, feed, sampling, feed_ratios)
    fastest, cells = time_joint_path(dynamics, path, jumping, count=count, feed=feed)
    if sampling is not None:
        # a program that is much finer than the rows takes longer and gains nothing
        rows = int(np.ceil(fastest.duration * sampling.rate))
        count = min(count, max(rows, _LEAST_CELLS))
    found = search.within(*search.rough(fastest, cells, count))
    _refuse(
        found.ratios,
        search.outputs(cells),
        1 + _UNSETTLED,
        "and slowing down does not settle it; raise the torque rate or the jerk",
    )
    return found.law


@dataclass(frozen=True)
class _Found:
    """A motion, held against its limits."""

    law: RateLimitedLaw
    ratios: OutputRatios
    rounds: int
    """solutions so far"""

    @property
    def worst(self) -> float:
        """The largest part of a limit."""
        return _largest(self.ratios)

    @property
    def rank(self) -> tuple[float, float]:
        """Less is better: what is above the limits, then the duration."""
        return max(self.worst, 1.0), float(self.law.duration)


@dataclass(frozen=True)
class _Search:
    """One path and what a motion along it has to keep."""

    dynamics: PathDynamics
    path: JointPath
    limits: MotionLimits
    feed: FeedBound | None
    sampling: Sampling | None
    feed_ratios: FeedRatios | None

    def outputs(self, cells: Cells) -> ConstrainedOutputs:
        """What has limits, on cells of the path."""
        return ConstrainedOutputs.of(cells, self.limits, self.dynamics.friction)

    def ratios(self, law: RateLimitedLaw) -> OutputRatios:
        """A motion held against its limits."""
        return law.sampled_ratios(self.path, self.limits, self.dynamics, HALVINGS)

    def as_read(self, law: RateLimitedLaw, ratios: OutputRatios) -> OutputRatios:
        """The same with torques, accelerations, speeds and feed of the rows, and of what is read
        between them."""
        if self.sampling is None or self.dynamics.irregular:
            return ratios
        n = self.path.n
        torque, bend, speed = self.sampling.ratios(
            law, self.path, self.limits, self.dynamics, ratios.s, self.feed_ratios
        )
        value = ratios.value.copy()
        value[:, :n] = np.maximum(value[:, :n], torque)
        value[:, n:] = np.maximum(value[:, n:], bend[:, self.limits.bounds_bend])
        return replace(ratios, value=value, speed=np.hstack([ratios.speed, speed]))

    def program(self, s: Array, near: TimeLaw) -> GriddedProgram:
        """The program on a grid, near a motion that is known."""
        return GriddedProgram.on(self.dynamics, self.path, self.limits, s, near, self.feed)

    def rough(self, fastest: TimeLaw, cells: Cells, count: int) -> tuple[Array, RateLimitedLaw]:
        """A grid that is fine where it has to be, from a first motion on a coarse one, and that
        motion."""
        s = first_grid(self.path, fastest, self.outputs(cells), count)
        problem = self.program(s, fastest)
        law = problem.law(solve(problem.program, problem.start(), gap=_ROUGH))
        return refined(law, problem.program.outputs), law

    def within(self, s: Array, rough: RateLimitedLaw) -> _Found:
        """The motion on a fine grid, within all limits.

        Slowed by the last ten-thousandths it has its rows elsewhere, and they may swing above a
        limit where they did not. The whole is slowed by what swings at one place then: where that
        costs much the place is held back, too, and the program solved again; the best motion is
        kept.
        """
        problem = self.program(s, rough)
        problem, z, found = self.settled(problem, problem.start(rough), _WARM, _ROUNDS)
        once = self.slowed(found)
        best = self.slowed_until_inside(once)
        last = found.rounds + _AGAIN
        while found.rounds < last and self.loses(best, found):
            try:
                problem = problem.holding_back(once.ratios, once.law)
                problem, z, found = self.settled(problem, problem.inside(z), _NEAR, last, found)
            except InfeasiblePointError:
                # so much cannot be held back; the motion that there is holds without
                break
            once = self.slowed(found)
            inside = self.slowed_until_inside(once)
            better = inside.rank < best.rank
            best = replace(inside if better else best, rounds=found.rounds)
            if not better:
                break
        return best

    def loses(self, inside: _Found, found: _Found) -> bool:
        """Whether a motion is not within its limits, or was slowed by more than a row and a
        thousandth to be.
        """
        row = 0.0 if self.sampling is None else 1 / self.sampling.rate
        least = max(_LOST * found.law.duration, row)
        return inside.worst > 1 or inside.law.duration > found.law.duration + least

    def settled(
        self,
        problem: GriddedProgram,
        z: Array,
        barrier: float,
        last: int,
        before: _Found | None = None,
    ) -> tuple[GriddedProgram, Array, _Found]:
        """The program solved again as long as its motion is above a limit, its unknowns, and the
        motion.

        Args:
            problem: the first program.
            z: its unknowns to begin with, inside.
            barrier: to begin with.
            last: how many solutions there may be in all.
            before: what was found before.
        """
        done = 0 if before is None else before.rounds
        for turn in range(done + 1, last + 1):
            solution = solve(problem.program, z, barrier=barrier, gap=_GAP)
            law = problem.law(solution)
            found = _Found(law, self.as_read(law, self.ratios(law)), turn)
            if found.worst <= 1 + _ENOUGH or turn == last:
                break
            _refuse(
                found.ratios,
                problem.program.outputs,
                _HOPELESS,
                "which no timing cures: an effect's torque jumps there by itself",
            )
            problem = problem.holding_back(found.ratios, law)
            z = problem.inside(solution)
            barrier = _NEAR
        return problem, solution, found

    def slowed_until_inside(self, found: _Found) -> _Found:
        """The motion slowed by what is still above its limits."""
        for _ in range(_ROUNDS):
            slower = self.slowed(found)
            if slower is found:
                break
            found = slower
        return found

    def slowed(self, found: _Found) -> _Found:
        """The motion slowed once by what is above its limits, if anything is that may be cured."""
        worst = found.worst
        if worst <= 1 - ROUNDING or worst > _HOPELESS:
            return found
        # torque falls with the square of the speed, but for gravity and friction
        law = found.law.slowed(1 + 0.7 * (worst - 1) + _BEYOND)
        return replace(found, law=law, ratios=self.as_read(law, self.ratios(law)))


def _refuse(ratios: OutputRatios, outputs: ConstrainedOutputs, most: float, why: str) -> None:
    """Raise InfeasiblePointError where a ratio is larger than `most`."""
    worst = _known(np.maximum(ratios.value, ratios.rate))
    if worst.max() <= most:
        return
    place, output = np.unravel_index(int(np.argmax(worst)), worst.shape)
    is_torque = np.isfinite(outputs.friction[3, 0, output])
    names = ("torque", "torque rate") if is_torque else ("acceleration", "jerk")
    kind = names[int(ratios.rate[place, output] > ratios.value[place, output])]
    axis = outputs.axis[0, output]
    raise InfeasiblePointError(
        float(ratios.s[place]),
        f", the {kind} of axis {axis} is {worst.max():.3g} times its limit, {why}",
    )


def _largest(ratios: OutputRatios) -> float:
    return max(float(_known(r).max()) for r in (ratios.value, ratios.rate, ratios.speed))


def _known(ratio: Array) -> Array:
    """A bound that could not be computed holds nothing."""
    return np.where(np.isnan(ratio), np.inf, ratio)
