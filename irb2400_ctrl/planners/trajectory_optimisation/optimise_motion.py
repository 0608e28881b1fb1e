"""`optimise_motion`: the fastest, or most economical, motion through joint way-points with the
geometry left free.

A fixed path leaves only its timing to choose. Here the joints may go anywhere between the
way-points: `Transcription` finds geometry and time together at knots, and the certified timing
takes the geometry and times it again, so that nothing is violated between knots either. The result
carries a certificate that `check` confirms without any solver. Whatever the optimiser finds
competes with its own warm start, and the result says which one won and why.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.cells import reversals
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, path_dynamics
from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.trajectory_optimisation.knots import Knots, Solved
from irb2400_ctrl.planners.trajectory_optimisation.optimised import (
    MotionOutcome,
    Optimised,
    outcome,
)
from irb2400_ctrl.planners.trajectory_optimisation.retiming import (
    rate_excess,
    slowed_outcome,
    smooth_outcome,
    smooth_path,
)
from irb2400_ctrl.planners.trajectory_optimisation.transcription import Objective, Transcription
from irb2400_ctrl.planners.trajectory_optimisation.warm_start import (
    Start,
    clamped,
    knots_of,
    shares,
    time_again,
    warm_start,
)
from irb2400_ctrl.planners.trajectory_optimisation.waypoints import (
    checked_waypoints,
    signed_margins,
)
from irb2400_ctrl.robot import Robot

Array = npt.NDArray[np.float64]

# part of the torque limits left to what happens between knots; for energy, what the motion would be
# slowed by instead
_RESERVE = 0.001
_RESERVE_KEPT = 0.01
# loss of duration by timing again with a limited torque rate that is worth another turn
_LOST = 1.003
# how often a motion that falls short between knots is sent back with tighter bounds
_TURNS = 3
# duration that a motion of least energy may take, as a multiple of the fastest of its warm start
_LONGER = 1.2


def optimise_motion(
    robot: Robot,
    waypoints: ArrayLike,
    *,
    objective: Objective = "time",
    duration: float | None = None,
    margins: Mapping[str, float] | None = None,
    torque_rate: ArrayLike | None = None,
    limits: MotionLimits | None = None,
    start: Start | None = None,
    intervals: int | None = None,
    wall_time: float = 8.0,
) -> Optimised:
    """A rest-to-rest motion through the way-points, in order, free in between.

    Args:
        robot: the arm.
        waypoints: actuator angles inside the joint box, two for point to point [rad], shape (k, n).
        objective: "time", or "energy": the sum over the drives of the integral of max(0, tau qd).
        duration: longest duration [s]; for energy by default 1.2 times the fastest time of the warm
            start.
        margins: least |sin q5| ("wrist", [-]), |r| ("shoulder", [m]), |k| ("elbow", [m]) all over
            the path; the way-points must lie on one side of each singularity named.
        torque_rate: limit of the change of the torque, dry friction apart [Nm/s], shape (n,). The
            torque then starts and ends at what holds the arm. Bounded at every instant; for energy
            seen at 5 kHz.
        limits: default those of the robot.
        start: warm start: a joint path (of the path planner), its certificate, or a joint move;
            default the cubic spline through the way-points at even parameters.
        intervals: of the transcription, over all segments; default 300, and 200 where there are
            more variables, for energy or with a limited torque rate.
        wall_time: for the solver [s].

    Raises:
        InputError: way-points that are not k > 1 vectors inside the joint box, or on both sides of
        a singularity. InfeasibleError: neither the optimiser nor the warm start gives a motion
        within the limits.
    """
    dynamics = path_dynamics(robot)
    limits = MotionLimits.of(robot) if limits is None else limits
    W = checked_waypoints(dynamics.model, waypoints)
    bounds = signed_margins(dynamics.model, W, margins or {})
    rate = (
        None
        if torque_rate is None
        else np.broadcast_to(np.asarray(torque_rate, dtype=float), (robot.n,))
    )
    if rate is not None and not (np.isfinite(rate) & (rate > 0)).all():
        raise InputError(
            f"torque_rate is {rate.tolist()}, expected one positive number of Nm/s per axis"
        )
    if duration is not None and not duration > 0:
        raise InputError(f"duration is {duration}, expected a positive number of seconds")
    if intervals is None:
        intervals = 300 if objective == "time" and rate is None else 200
    if objective not in ("time", "energy") or intervals < 1:
        raise InputError(
            f"objective {objective!r} with {intervals} intervals, expected time or energy, and at "
            "least 1"
        )
    clock = [time.perf_counter()]
    guess, at, reference = warm_start(dynamics, limits, W, start)
    clock.append(time.perf_counter())
    longest = np.inf if duration is None else duration
    if objective == "energy" and reference is not None:
        longest = _LONGER * reference.duration if duration is None else duration
        reference = _slowed(reference, dynamics, longest)
    elif rate is not None and reference is not None:
        # where it cannot keep the rate, the one with jumps stays: to be told about, not to be
        # returned
        with suppress(InfeasibleError):
            reference = smooth_outcome(dynamics, reference.certificate.path, limits, rate)
    wish = _Wish(dynamics, limits, W, objective, longest, bounds, rate)
    counts = shares(at, intervals)
    solved, best, problem = _search(wish, knots_of(guess, at, counts, longest), counts, wall_time)
    clock.append(time.perf_counter())
    return _compared(wish, solved, best, problem, reference, at, counts, np.diff(clock))


def _slowed(found: MotionOutcome, dynamics: PathDynamics, duration: float) -> MotionOutcome:
    """The same motion evenly slowed to a longer duration: what its energy is to be compared
    with."""
    factor = found.duration / duration
    if factor >= 1:
        return found
    c = found.certificate
    return outcome(Certificate(c.path, TimeLaw(c.law.s, factor**2 * c.law.x), c.limits), dynamics)


@dataclass(frozen=True)
class _Wish:
    """What is asked for."""

    dynamics: PathDynamics
    limits: MotionLimits
    waypoints: Array
    objective: Objective
    longest: float
    margins: tuple[tuple[int, float], ...]
    torque_rate: Array | None

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
        q = path(np.concatenate([path.knots, reversals(path)]))
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


def _search(
    wish: _Wish, guess: Knots, counts: tuple[int, ...], wall_time: float
) -> tuple[Solved, MotionOutcome | None, str | None]:
    """Solve, time again, and tighten what the path between knots falls short of; the best motion of
    all turns."""
    dynamics = wish.dynamics
    reserve = _RESERVE_KEPT if wish.objective == "energy" else _RESERVE
    margins = wish.margins
    longest = wish.longest * (1 - _RESERVE)
    rate = wish.torque_rate
    left = wall_time
    best = None
    first = None
    for turn in range(_TURNS):
        program = Transcription(
            dynamics.model,
            wish.limits,
            wish.waypoints,
            counts,
            wish.objective,
            longest,
            margins,
            rate,
            reserve,
        )
        solved = program.solve(guess, max(left, 1e-6))
        left -= solved.wall_time
        try:
            found = wish.timed(solved.knots)
        except InfeasibleError as error:
            return solved, best, _placed(error, solved.knots, counts)
        problem = wish.missed(found)
        first = first or problem
        if problem is None and (best is None or wish.cost(found) < wish.cost(best)):
            best = found
        lacking = [max(abs(b) - found.margins[NAMES[k]], 0.0) for k, b in wish.margins]
        late = found.duration > wish.longest
        lost = (
            wish.smooth
            and found.duration > _LOST * solved.knots.time[-1]
            and turn == 0
            and left > solved.wall_time
        )
        if not (late or lost or any(lacking)):
            break
        if late:
            longest *= (1 - _RESERVE) * wish.longest / found.duration
        if lost and rate is not None:
            rate = rate / np.maximum(rate_excess(dynamics, solved.knots, rate), 1.0)
        margins = tuple(
            (k, b + np.sign(b) * 1.5 * gap) for (k, b), gap in zip(margins, lacking, strict=True)
        )
        if solved.converged:
            guess = solved.knots
    return solved, best, None if best is not None else first


def _placed(error: InfeasibleError, knots: Knots, counts: tuple[int, ...]) -> str:
    """An error with its place among the way-points: the parameter of an optimised path means
    nothing to anybody."""
    if not isinstance(error, InfeasiblePointError):
        return str(error)
    # a smooth path's parameter is less than a millisecond away from the time
    at = int(np.clip(np.searchsorted(knots.time[_passed(counts)], error.s), 1, len(counts)))
    return f"between way-points {at} and {at + 1}{error.reason.split(';')[0]}"


def _compared(
    wish: _Wish,
    solved: Solved,
    best: MotionOutcome | None,
    problem: str | None,
    reference: MotionOutcome | None,
    at: Array,
    counts: tuple[int, ...],
    clock: Array,
) -> Optimised:
    """The better of optimised motion and warm start, and why."""
    said = f"IPOPT: {solved.status} after {solved.iterations} iterations"
    fit = reference if reference is not None and wish.missed(reference) is None else None
    if best is None and fit is None:
        why = "no timing within the limits" if reference is None else wish.missed(reference)
        raise InfeasibleError(
            f"no motion found. {said}; its motion: {problem}. The warm start: {why}; allow more "
            "time, lower the "
            "margins, or move the way-points"
        )
    fell_back = best is None or (fit is not None and wish.cost(fit) <= wish.cost(best))
    motion = fit if fell_back else best
    assert motion is not None
    if best is None:
        message = f"fell back to the warm start: {problem} ({said})"
    elif fell_back:
        message = f"fell back to the warm start, which is no worse ({said})"
    elif not solved.converged:
        message = (
            "the solver did not converge, its motion is better than the warm start and "
            f"certified ({said})"
        )
    else:
        message = f"optimised ({said})"
    if fell_back:
        passed = at
    else:
        path = motion.certificate.path
        law = motion.certificate.law
        passed = np.interp(path.knots[_passed(counts)], law.s, law.time)
    stages = ("warm_start", "optimise_and_time")
    wall = {**dict(zip(stages, map(float, clock), strict=True)), "solver": solved.wall_time}
    return Optimised(
        wish.waypoints,
        passed,
        wish.objective,
        motion,
        reference,
        fell_back,
        message,
        solved.status,
        solved.iterations,
        wall,
    )


def _passed(counts: tuple[int, ...]) -> npt.NDArray[np.int64]:
    """Numbers of the knots that are way-points."""
    return np.concatenate([[0], np.cumsum(counts)])
