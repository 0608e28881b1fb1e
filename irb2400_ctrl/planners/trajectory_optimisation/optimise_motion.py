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
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array, one_thread
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.given import whole
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.trajectory_optimisation.knot_coupling import Objective
from irb2400_ctrl.planners.trajectory_optimisation.knots import Knots, Solved
from irb2400_ctrl.planners.trajectory_optimisation.motion_request import MotionRequest
from irb2400_ctrl.planners.trajectory_optimisation.optimised import (
    MotionOutcome,
    Optimised,
    outcome,
    torque_as_read,
)
from irb2400_ctrl.planners.trajectory_optimisation.retiming import (
    rate_excess,
    smooth_outcome,
)
from irb2400_ctrl.planners.trajectory_optimisation.transcription import ITERATIONS, Transcription
from irb2400_ctrl.planners.trajectory_optimisation.warm_start import (
    Start,
    knots_of,
    shares,
    warm_start,
)
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

# part of the torque limits left to what happens between knots; for energy, what the motion would be
# slowed by instead
_RESERVE = 0.001
_RESERVE_KEPT = 0.01
# loss of duration by timing again with a limited torque rate that is worth another turn
_LOST = 1.003
# of a torque limit that rows read as cubics may ask for before it is said
_AS_READ = 1.01
# how often a motion that falls short between knots is sent back with tighter bounds
_TURNS = 3
# duration that a motion of least energy may take, as a multiple of the fastest of its warm start
_LONGER = 1.2


@typed
@one_thread()
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
    iterations: int = ITERATIONS,
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
            sampled at 5 kHz. `torque_rate_Nm_s` of the robot file is kept in any case.
        limits: default those of the robot.
        start: warm start: a joint path (of the path planner), its certificate, a joint move or a
            trajectory; default the cubic spline through the way-points at even parameters.
        intervals: of the transcription, over all segments; default 300, and 200 where there are
            more variables, for energy or with a limited torque rate.
        iterations: of the solver at most, over all its turns. No clock stops it: the same request
            has the same answer on a busy machine.

    Raises:
        InputError: way-points that are not k > 1 vectors inside the joint box, or on both sides of
        a singularity. InfeasibleError: neither the optimiser nor the warm start gives a motion
        within the limits.
    """
    request = MotionRequest.of(robot, waypoints, objective, duration, margins, torque_rate, limits)
    if intervals is None:
        intervals = 300 if objective == "time" and request.torque_rate is None else 200
    whole("intervals", intervals, 1)
    whole("iterations", iterations)
    clock = [time.perf_counter()]
    guess, at, reference = warm_start(request.dynamics, request.limits, request.waypoints, start)
    clock.append(time.perf_counter())
    request, reference = _comparable(request, reference, duration)
    counts = shares(at, intervals)
    knots = knots_of(guess, at, counts, request.longest)
    solved, best, problem = _search_in_time(request, reference, knots, counts, iterations)
    clock.append(time.perf_counter())
    return _compared(request, solved, best, problem, reference, at, counts, np.diff(clock))


def _comparable(
    request: MotionRequest, reference: MotionOutcome | None, duration: float | None
) -> tuple[MotionRequest, MotionOutcome | None]:
    """The warm start made to keep what is asked for, where it can, and the longest duration that
    follows from it."""
    if reference is None:
        return request, None
    if request.objective == "energy":
        longest = _LONGER * reference.duration if duration is None else duration
        return replace(request, longest=longest), _slowed(reference, request.dynamics, longest)
    if request.torque_rate is not None:
        # where it cannot keep the rate, the one with jumps stays: to be told about, not to be
        # returned
        path = reference.certificate.path
        with suppress(InfeasibleError):
            reference = smooth_outcome(request.dynamics, path, request.limits, request.torque_rate)
    return request, reference


def _slowed(found: MotionOutcome, dynamics: PathDynamics, duration: float) -> MotionOutcome:
    """The same motion evenly slowed to a longer duration: what its energy is to be compared
    with."""
    if duration <= found.duration:
        return found
    c = found.certificate
    law = c.law.slowed(duration / found.duration)
    return outcome(Certificate(c.path, law, c.limits), dynamics)


def _search_in_time(
    request: MotionRequest,
    reference: MotionOutcome | None,
    knots: Knots,
    counts: tuple[int, ...],
    iterations: int,
) -> tuple[Solved, MotionOutcome | None, str | None]:
    """`_search`, of least energy only where there may be time for it: whether there is, the fastest
    motion says in a hundredth of what IPOPT takes to prove that there is not."""
    longest = request.longest
    slow = reference is None or reference.duration > longest
    if request.objective == "energy" and slow and np.isfinite(longest):
        fast = replace(request, objective="time", torque_rate=None)
        solved, best, problem = _search(fast, knots, counts, iterations)
        if best is None and solved.converged and solved.knots.time[-1] > longest:
            return solved, None, problem
    return _search(request, knots, counts, iterations)


def _search(
    request: MotionRequest, guess: Knots, counts: tuple[int, ...], iterations: int
) -> tuple[Solved, MotionOutcome | None, str | None]:
    """Solve, time again, and tighten what the path between knots falls short of; the best motion of
    all turns."""
    dynamics = request.dynamics
    reserve = _RESERVE_KEPT if request.objective == "energy" else _RESERVE
    margins = request.margins
    # the fastest motion is fast enough, or none is: a bound on it would only have IPOPT prove that,
    # which takes it minutes
    longest = request.longest * (1 - _RESERVE) if request.objective == "energy" else np.inf
    rate = request.torque_rate
    left = iterations
    best = None
    first = None
    for turn in range(_TURNS):
        program = Transcription(
            dynamics.model,
            request.limits,
            request.waypoints,
            counts,
            request.objective,
            longest,
            margins,
            rate,
            reserve,
        )
        solved = program.solve(guess, max(left, 0))
        left -= solved.iterations
        try:
            found = request.timed(solved.knots)
        except InfeasibleError as error:
            return solved, best, _placed(error, solved.knots, counts)
        problem = request.missed(found)
        first = first or problem
        if problem is None and (best is None or request.cost(found) < request.cost(best)):
            best = found
        lacking = [max(abs(b) - found.margins[NAMES[k]], 0.0) for k, b in request.margins]
        late = request.objective == "energy" and found.duration > request.longest
        lost = (
            request.smooth
            and found.duration > _LOST * solved.knots.time[-1]
            and turn == 0
            and left > solved.iterations
        )
        if not (late or lost or any(lacking)):
            break
        if late:
            longest *= (1 - _RESERVE) * request.longest / found.duration
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
    request: MotionRequest,
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
    fit = reference if reference is not None and request.missed(reference) is None else None
    if best is None and fit is None:
        why = "no timing within the limits" if reference is None else request.missed(reference)
        raise InfeasibleError(
            f"no motion found. {said}; its motion: {problem}. The warm start: {why}; allow more "
            "time, lower the "
            "margins, or move the way-points"
        )
    fell_back = best is None or (fit is not None and request.cost(fit) <= request.cost(best))
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
    found = Optimised(
        request.waypoints,
        passed,
        request.objective,
        motion,
        reference,
        fell_back,
        message,
        solved.status,
        solved.iterations,
        wall,
    )
    model = request.dynamics.model
    read = torque_as_read(model, found.trajectory(model))
    return replace(found, torque_as_read=read, message=message + _said_as_read(read))


def _said_as_read(ratio: float) -> str:
    """What the rows ask for, where that is more than the motion itself does."""
    if ratio <= _AS_READ:
        return ""
    return (
        f"; its torque jumps, and read as cubics the rows of trajectory() ask for "
        f"{100 * ratio:.0f} % of a torque limit: torque_rate=50 * robot.tau_max keeps them within "
        "1 %, in a motion some per cent longer"
    )


def _passed(counts: tuple[int, ...]) -> npt.NDArray[np.int64]:
    """Numbers of the knots that are way-points."""
    return np.concatenate([[0], np.cumsum(counts)])
