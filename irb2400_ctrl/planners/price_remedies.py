"""What each remedy of a wrist singularity would cost, in seconds as well."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.redundancy.wrist_remedies import (
    Remedy,
    damped,
    of_choice,
    turned_about_axis,
)
from irb2400_ctrl.planners.timing.path_timer import PathTimer
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_choices import TimedChoice
from irb2400_ctrl.planners.toolpath.orientation import Orientation


def price_remedies(
    timer: PathTimer,
    orientation: Orientation,
    timed: Sequence[TimedChoice],
    chosen: TimedChoice,
    axis_tolerance: float,
) -> list[Remedy]:
    """The cheapest of each kind of remedy, for a path that comes close to the wrist singularity.

    Args:
        timer: of the paths.
        orientation: of the tool along the path.
        timed: choices that have a motion.
        chosen: the one that was taken.
        axis_tolerance: by which the tool axis may lean [rad].
    """
    passing = chosen.choice.passing
    if passing is None or not passing.passages:
        return []
    best: dict[str, Remedy] = {}
    for option in timed:
        remedy = of_choice(option.choice, option.fastest.duration, axis_tolerance)
        if remedy is None:
            continue
        if remedy.name not in best or remedy.duration < best[remedy.name].duration:
            best[remedy.name] = remedy
    model = timer.dynamics.model
    for choice, angle in turned_about_axis(model, orientation):
        followed = choice.followed
        with suppress(InfeasibleError):
            path = TaskPath.of(model, orientation, followed)
            duration = timer.fastest(path).duration
            name = f"turn the tool about its axis ({choice.kind})"
            best[name] = Remedy(name, duration, followed.error, angle, False)
    with suppress(InfeasibleError):
        followed = damped(model, orientation, chosen.path.followed)
        path = TaskPath.of(model, orientation, followed)
        duration = timer.fastest(path).duration
        name = "damped least squares"
        best[name] = Remedy(name, duration, followed.error, followed.axis_error, False)
    return sorted(best.values(), key=lambda remedy: remedy.duration)
