"""Time every way to follow a tool path, and say which is best."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.redundancy.choice import LONG, Choice
from irb2400_ctrl.planners.redundancy.wrist_passage import EXACT
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.path_timer import PathTimer
from irb2400_ctrl.planners.timing.rate_limited.rate_summary import rate_summary
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_law import TimeLaw
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
    timer: PathTimer,
    orientation: Orientation,
    found: Sequence[Choice],
    progress: Callable[[str], None],
) -> list[TimedChoice]:
    """The choices that have a motion within the limits of torque and speed, each with its fastest;
    of a long path only the one that is worth most, for each takes seconds.

    Args:
        timer: of the paths.
        orientation: of the tool along the path.
        found: branches and tool rotations, the most promising of each kind first.
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
        path = TaskPath.of(timer.dynamics.model, orientation, choice.followed)
        try:
            law = timer.fastest(path)
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


RATES_UP_TO = 1000
"""pieces of a path above which rates that nobody stated are not limited: it would take minutes"""
LONG_NOTE = (
    f"path of more than {RATES_UP_TO} pieces: the torque may jump, and the motion is slowed until "
    "its rows keep the limits; --torque-rate limits the jumps instead (faster motion, longer wait)"
)


def limit_rates(timer: PathTimer, ranked: Sequence[TimedChoice]) -> TimedChoice:
    """The best choice that has a motion with limits of torque rate and jerk, too, with its law.

    Args:
        timer: of the paths.
        ranked: choices that have a motion, best first.

    Raises:
        InfeasibleError: none has one; says where.
    """
    if not timer.options.rates_stated and len(ranked[0].path.joints.knots) > RATES_UP_TO:
        return replace(ranked[0], rates={"rates_note": LONG_NOTE})
    problem: InfeasibleError | None = None
    for option in ranked:
        path = option.path
        try:
            law = timer.rate_limited(path)
        except InfeasiblePointError as error:
            problem = _placed(error, path)
            continue
        limits = timer.options.limits
        rates = rate_summary(law, path.joints, limits, timer.dynamics, option.fastest)
        return replace(option, law=law, rates=rates)
    if not timer.options.rates_stated:
        # a torque that jumps by itself: the rows are slowed instead, until they keep the limits
        return ranked[0]
    raise problem or InfeasibleError("no motion within the limits")


def _placed(error: InfeasibleError, path: TaskPath) -> InfeasibleError:
    """The same error with its place as a length of the TCP's way."""
    if not isinstance(error, InfeasiblePointError):
        return error
    return InfeasiblePointError(float(path.tcp.way(error.s)), error.reason)
