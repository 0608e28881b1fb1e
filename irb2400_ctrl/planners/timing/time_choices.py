"""Time every way to follow a tool path, and say which is best."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.enclosure.cells import enclose, grid
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.redundancy.choice import LONG, Choice
from irb2400_ctrl.planners.redundancy.wrist_passage import EXACT
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.rate_summary import rate_summary
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.timing.sampled_reference.settled_reference import (
    Settled,
    settled_reference,
)
from irb2400_ctrl.planners.timing.sampled_timing import time_with_samples
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.planners.toolpath.orientation import Orientation


@dataclass(frozen=True, eq=False)
class TimedChoice:
    """A way to follow a tool path, and when it is where."""

    choice: Choice
    path: TaskPath
    law: TimeLaw
    fastest: TimeLaw
    """the law without limits of torque rate and jerk"""
    rates: dict[str, Any] = field(default_factory=dict)
    """of `rate_summary`; empty where rates are not limited"""

    @property
    def rank(self) -> tuple[float, float, float]:
        """Larger margin and clearance first as long as they are not comfortable, then what gives
        way less to a cutting force, then the shorter duration."""
        return *self.choice.rank, self.fastest.duration


def time_choices(
    dynamics: PathDynamics,
    orientation: Orientation,
    found: Sequence[Choice],
    options: TimingOptions,
    progress: Callable[[str], None],
) -> list[TimedChoice]:
    """The choices that have a motion within the limits of torque and speed, each with its fastest;
    of a long path only the one that is worth most, for each takes seconds.

    Args:
        dynamics: the arm's torque along the path.
        orientation: of the tool along the path.
        found: branches and tool rotations, the most promising of each kind first.
        options: of the timing.
        progress: told what is done now.

    Raises:
        InfeasibleError: none has one; says where.
    """
    timed: list[TimedChoice] = []
    problem: InfeasibleError | None = None
    long = bool(found) and len(found[0].followed.joints.knots) > LONG
    ordered = sorted(found, key=lambda choice: choice.rank) if long else found
    for number, choice in enumerate(ordered):
        if long and timed:
            break
        progress(f"{100 * number / len(found):.0f} %")
        path = TaskPath.of(dynamics.model, orientation, choice.followed)
        try:
            law = fastest(dynamics, path, options)
            timed.append(TimedChoice(choice, path, law, law))
        except InfeasibleError as error:
            problem = _placed(error, path)
    if not timed:
        raise problem or InfeasibleError("no motion within the limits")
    return timed


def best_first(timed: Sequence[TimedChoice], axis_tolerance: float) -> list[TimedChoice]:
    """Those that stay near enough to the stated orientation, best first.

    Raises:
        InfeasibleError: none does; says where the wrist is in the way, and by how much.
    """
    allowed = [one for one in timed if one.choice.turn <= max(axis_tolerance, EXACT)]
    if not allowed:
        raise InfeasibleError(_too_far(min(timed, key=lambda one: one.choice.turn), axis_tolerance))
    return sorted(allowed, key=lambda one: one.rank)


def _too_far(nearest: TimedChoice, axis_tolerance: float) -> str:
    passing = nearest.choice.passing
    assert passing is not None
    worst = max(passing.turned, key=lambda passage: passage.miss)
    needed = np.degrees(worst.miss)
    return (
        f"the path passes the wrist singularity at {1e3 * worst.s:.0f} mm by {needed:.3g} deg, and "
        "within the joint ranges and the torque there is no way past it: found that the tool has "
        f"to turn by {needed:.3g} deg to pass through, expected at most "
        f"{np.degrees(axis_tolerance):.3g} deg (--axis-tolerance-deg, axis_tolerance); allow more, "
        "free the rotation about the tool axis, or place the path elsewhere"
    )


_SHORT = 300
"""knots of a path of which both laws are made"""
# cubics through angles and speeds swing above an acceleration between two limits by up to 2/3
_ROOM_FOR_ROWS = 0.6
RATES_UP_TO = 1000
"""pieces of a path above which rates that nobody stated are not limited: it would take minutes"""
LONG_NOTE = (
    f"path of more than {RATES_UP_TO} pieces: the torque may jump, and the motion is slowed until "
    "its rows keep the limits; --torque-rate limits the jumps instead (faster motion, longer wait)"
)


def limit_rates(
    dynamics: PathDynamics, ranked: Sequence[TimedChoice], options: TimingOptions
) -> TimedChoice:
    """The best choice that has a motion with limits of torque rate and jerk, too, with its law.

    Args:
        dynamics: the arm's torque along the path.
        ranked: choices that have a motion, best first.
        options: of the timing.

    Raises:
        InfeasibleError: none has one; says where.
    """
    if not options.rates_stated and len(ranked[0].path.joints.knots) > RATES_UP_TO:
        return replace(ranked[0], rates={"rates_note": LONG_NOTE})
    problem: InfeasibleError | None = None
    for option in ranked:
        path = option.path
        try:
            law = rate_limited(dynamics, path, options)
        except InfeasiblePointError as error:
            problem = _placed(error, path)
            continue
        rates = rate_summary(law, path.joints, options.limits, dynamics, option.fastest)
        return replace(option, law=law, rates=rates)
    if not options.rates_stated:
        # a torque that jumps by itself: the rows are slowed instead, until they keep the limits
        return ranked[0]
    raise problem or InfeasibleError("no motion within the limits")


def rate_limited(dynamics: PathDynamics, path: TaskPath, options: TimingOptions) -> RateLimitedLaw:
    """The fastest law with limits of torque rate and jerk, too.

    Args:
        dynamics: the arm's torque along the path.
        path: the TCP along the joints; options: of the timing.

    Raises:
        InfeasiblePointError: there is none; says where.
    """
    return time_rate_limited(
        dynamics,
        path.joints,
        options.limits,
        count=max(options.cells // 2, 50),
        feed=path.feed,
        sampling=options.sampling,
        feed_ratios=path.feed_ratios,
    )


def settle(
    dynamics: PathDynamics, timed: TimedChoice, options: TimingOptions
) -> tuple[TimedChoice, Settled]:
    """The choice as its rows say it, slowed by what they swing above the limits; with toppra's
    timing as it is.

    Where the acceleration may jump, axes that carry the part, and those of the arm with a limit of
    it, leave room for what rows swing above it: they are too weak to be slowed around a few rows.

    Args:
        dynamics: the arm's torque along the path.
        timed: the choice with its law.
        options: of the timing.
    """
    found = settled_law(dynamics, timed.path, timed.law, options)
    return replace(timed, law=found.law), found


def settled_law(
    dynamics: PathDynamics, path: TaskPath, law: TimeLaw, options: TimingOptions
) -> Settled:
    """The rows of a law, or of one that leaves room for them; of a short path the shorter of both,
    as a few rows that are slowed may cost less than the room.

    Args:
        dynamics: the arm's torque along the path.
        path: the TCP along the joints.
        law: its fastest.
        options: of the timing.
    """
    limits = options.limits

    def settled(law: TimeLaw) -> Settled:
        sampling = options.sampling
        return settled_reference(dynamics, path, law, limits, sampling, options.certified)

    room = roomy(dynamics, path, law, options)
    found = settled(room)
    if room is law or len(path.joints.knots) > _SHORT:
        return found
    other = settled(law)
    keeps = other.worst(limits) <= max(1.0, found.worst(limits))
    return other if keeps and other.law.duration < found.law.duration else found


def roomy(dynamics: PathDynamics, path: TaskPath, law: TimeLaw, options: TimingOptions) -> TimeLaw:
    """The law, or where its acceleration may jump and has a limit, one that leaves room for the
    rows.

    Args:
        dynamics: the arm's torque along the path.
        path: the TCP along the joints.
        law: its fastest.
        options: of the timing.
    """
    limits = options.limits
    swings = options.sampling.interpolation == "cubic" and np.isfinite(limits.qdd_max).any()
    jumps = options.certified and isinstance(law, PiecewiseConstantLaw)
    if not (jumps and (dynamics.external or swings)):
        return law
    kept = limits.with_room(dynamics.model.robot.n, _ROOM_FOR_ROWS)
    return fastest(dynamics, path, replace(options, limits=kept))


def fastest(dynamics: PathDynamics, path: TaskPath, options: TimingOptions) -> TimeLaw:
    """The fastest law of the back-end, or of the timing for effects that have no bound.

    Args:
        dynamics: the arm's torque along the path.
        path: the TCP along the joints.
        options: of the timing.

    Raises:
        InfeasibleError: no motion within the limits; says where.
    """
    joints = path.joints
    limits = options.limits
    if options.certified and not dynamics.irregular:
        return time_joint_path(dynamics, joints, limits, count=options.cells, feed=path.feed)[0]
    s = grid(joints, options.cells)
    cells = enclose(dynamics, joints, s)
    friction = dynamics.friction
    if options.certified:
        return time_with_samples(dynamics, joints, cells, limits, friction, path.feed(s))
    # toppra takes seconds to import
    from irb2400_ctrl.planners.timing.toppra_timing import time_with_toppra

    return time_with_toppra(cells, limits, friction, path.feed(s))


def _placed(error: InfeasibleError, path: TaskPath) -> InfeasibleError:
    """The same error with its place as a length of the TCP's way."""
    if not isinstance(error, InfeasiblePointError):
        return error
    return InfeasiblePointError(float(path.tcp.way(error.s)), error.reason)
