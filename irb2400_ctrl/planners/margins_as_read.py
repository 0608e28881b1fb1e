"""Clearance and singularity margins of the rows as a controller reads them.

Between two rows a controller is not exactly on the path. What was bounded for the path is bounded
again for the joints' places between the rows, a curve of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.cell import Scene
from irb2400_ctrl.errors import CollisionError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance import Clearance, continuous_clearance, cutting_moves
from irb2400_ctrl.planners.clearance.clearance import entry
from irb2400_ctrl.planners.enclosure.deviation import singularity_margins
from irb2400_ctrl.planners.redundancy.choice import cutting_between
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.sampled_reference.settled_reference import Settled
from irb2400_ctrl.planners.timing.time_choices import TimedChoice
from irb2400_ctrl.planners.toolpath.orientation import Orientation

MOST_ROWS = 20_000
"""beyond so many rows the path's own margins are said: the rows lie the closer to it"""


@dataclass(frozen=True)
class Margins:
    """As `Plan` says them."""

    of: str
    """the "rows" as they are read, or the continuous "path" """
    singularity: dict[str, float]
    """lower bounds of |sin q5| [-], |r| [m], |k| [m]"""
    clearance: dict[str, Any]


def followed_as_read(timed: TimedChoice, settled: Settled) -> Followed:
    """The joints' places over the time, and where on the curve of the tool they are then."""
    places = settled.reference.places
    followed = timed.path.followed
    # the law's grid is finer than the rows where the path turns
    time = np.unique(np.concatenate([places.knots, timed.law.time]))
    u = np.interp(timed.law.at(time)[0], followed.joints.knots, followed.u)
    return Followed(places, np.interp(places.knots, time, u), 0.0, 0.0)


def margins_as_read(
    model: Model,
    orientation: Orientation,
    scene: Scene | None,
    timed: TimedChoice,
    settled: Settled,
) -> Margins:
    """Of the rows, or of the path where there are too many of them.

    Raises:
        CollisionError: the rows come nearer to something than the path does, and too near.
    """
    read = followed_as_read(timed, settled)
    way = timed.path.tcp.way
    if len(read.u) > MOST_ROWS:
        clearance = entry(timed.choice.clearance, way)
        return Margins("path", singularity_margins(model, timed.path.followed), clearance)
    near = None if scene is None else _clearance(scene, orientation, read)
    clearance = entry(near, lambda time: way(timed.law.at(np.array([time]))[0][0]))
    return Margins("rows", singularity_margins(model, read), clearance)


def _clearance(scene: Scene, orientation: Orientation, read: Followed) -> Clearance:
    """Of the rows; its `s` is a time [s]."""
    curve = orientation.curve
    moves = cutting_moves(curve.path, orientation.spindle)
    found = continuous_clearance(scene, read.joints, cutting_between(curve, moves, read.u))
    if not found.free:
        first, other = found.pair
        raise CollisionError(
            f"after {found.s:.3f} s, between the rows of the trajectory, {first} and {other} come "
            f"within {1e3 * found.value:.3f} mm, which the path itself does not; write more rows "
            "(--rate), or read them as cubic"
        )
    return found
