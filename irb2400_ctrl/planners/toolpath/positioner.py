"""Angles of a positioner (3+2) for a tool path: `irb2400_ctrl.cell.positioner` holds its
kinematics."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.positioner import Positioner, PositionerAxis
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.typed import typed

__all__ = ["Positioner", "PositionerAxis", "Setting", "choose_settings", "upright"]


# of the search for upright tool axes [rad]
_GRID = np.radians(5.0)
_FINEST = np.radians(1e-3)
# steps of the grid in a turn
_TURN = 72


@dataclass(frozen=True)
class Setting:
    """A stretch of a path machined at one position of the positioner."""

    first: int
    """first way-point"""
    last: int
    """last way-point, the first one of the next stretch"""
    angles: tuple[float, float]
    """(tilt, turn) [rad]"""
    worst_tilt: float
    """largest angle between tool axis and the favourable direction on the stretch [rad]"""


@typed
def choose_settings(
    positioner: Positioner,
    path: ToolPath,
    *,
    spindle_axis: ArrayLike = (0.0, 0.0, 1.0),
    favourable: ArrayLike = (0.0, 0.0, 1.0),
    largest_tilt: float = np.radians(30.0),
    step: float = np.radians(5.0),
) -> list[Setting]:
    """The fewest settings such that the tool axis stays within `largest_tilt` of a favourable
    direction.

    Each stretch goes on as long as some angles (of a grid) keep it within the bound; of these the
    ones with the smallest largest tilt are taken. Part of a feasible stretch is feasible, so greedy
    stretches are the fewest that the grid allows.

    Args:
        positioner: its frames and ranges.
        path: stated on the work-piece.
        spindle_axis: of the tool, for a path of full orientations.
        favourable: direction from tip to spindle that suits the robot, in its base; default
            upright.
        largest_tilt: at most 90 degrees, so that moves between two way-points stay within it as
            well [rad].
        step: of the grid of angles [rad].

    Raises:
        InfeasibleError: a way-point or a move between two that no angles bring within the bound;
        says which.
    """
    wanted = np.asarray(favourable, dtype=float)
    if wanted.shape != (3,) or not np.isfinite(wanted).all() or np.linalg.norm(wanted) < 1e-9:
        raise InputError(f"favourable direction is {favourable!r}, expected a vector of length 3")
    if not 0 < step <= np.pi / 2 or not 0 < largest_tilt <= np.pi / 2:
        raise InputError("expected a step and a largest tilt of more than 0 and at most 90 deg")
    axes = path.tool_axis(np.asarray(spindle_axis, dtype=float))
    low, high = positioner.ranges
    tilts, turns = (
        np.linspace(a, b, int(np.ceil((b - a) / step)) + 1) for a, b in zip(low, high, strict=True)
    )
    grid = np.array([(tilt, turn) for tilt in tilts for turn in turns])
    R = np.array([positioner.work_piece_pose(angles)[:3, :3] for angles in grid])
    # the favourable direction as the work-piece sees it at every setting of the grid
    seen = np.einsum("gji,j->gi", R, wanted / np.linalg.norm(wanted))
    bound = float(np.cos(largest_tilt)) - 1e-12
    settings: list[Setting] = []
    first = 0
    while first < len(path) - 1:
        last, cosine = _stretch(seen, axes, first, bound)
        if last == first:
            raise InfeasibleError(f"{positioner.name}: {_why(seen, axes, first, largest_tilt)}")
        # of equally good angles those nearest to zero
        good = np.flatnonzero(cosine >= cosine.max() - 1e-9)
        best = int(good[np.argmin(np.abs(grid[good]).sum(axis=1))])
        angles = (float(grid[best, 0]), float(grid[best, 1]))
        settings.append(
            Setting(first, last, angles, float(np.arccos(np.clip(cosine[best], -1.0, 1.0))))
        )
        first = last
    return settings


def upright(
    positioner: Positioner,
    path: ToolPath,
    spindle_axis: ArrayLike = (0.0, 0.0, 1.0),
    up: ArrayLike = (0.0, 0.0, 1.0),
) -> Setting:
    """The angles at which the largest angle between the tool axes of a path and the vertical is
    smallest: the best of a grid of 5 degrees, refined to 0.001 degrees.

    Args:
        positioner: its axes and ranges.
        path: on the part.
        spindle_axis: direction of the tool in the TCP frame, out of the spindle, shape (3,).
        up: the vertical in the robot base, shape (3,).
    """
    vertical = np.asarray(up, dtype=float)
    axes = path.tool_axis(np.asarray(spindle_axis, dtype=float))
    low, high = positioner.ranges

    def tilt_at(angles: Array) -> float:
        seen = vertical @ positioner.work_piece_pose(np.clip(angles, low, high))[:3, :3]
        return float(np.arccos(np.clip(axes @ seen, -1.0, 1.0)).max())

    steps = _GRID * np.arange(-_TURN, _TURN + 1)
    tilts, turns = (np.unique(np.clip(steps, a, b)) for a, b in zip(low, high, strict=True))
    grid = np.array([(tilt, turn) for tilt in tilts for turn in turns])
    found = np.array([tilt_at(angles) for angles in grid])
    # of equally good angles those nearest to zero
    good = np.flatnonzero(found <= found.min() + 1e-6)
    best = grid[good[np.argmin(np.abs(grid[good]).sum(axis=1))]]
    step = _GRID
    while step > _FINEST:
        around = best + step * np.array([(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)])
        around = np.clip(around, low, high)
        tilted = np.array([tilt_at(angles) for angles in around])
        better = int(np.argmin(tilted))
        if tilted[better] < tilt_at(best) - 1e-9:
            best = around[better]
        else:
            step /= 2
    return Setting(0, len(path) - 1, (float(best[0]), float(best[1])), tilt_at(best))


def _stretch(seen: Array, axes: Array, first: int, bound: float) -> tuple[int, Array]:
    """The furthest way-point that one setting reaches from `first`, and the smallest cosine at
    every setting (g,)."""
    cosine = seen @ axes[first]
    last = first
    for k in range(first + 1, len(axes)):
        with_next = np.minimum(cosine, seen @ axes[k])
        if with_next.max() < bound:
            break
        cosine = with_next
        last = k
    return last, cosine


def _why(seen: Array, axes: Array, first: int, largest_tilt: float) -> str:
    """What keeps the move from `first` to the next way-point from any setting."""
    for k in (first, first + 1):
        nearest = float(np.degrees(np.arccos(np.clip((seen @ axes[k]).max(), -1.0, 1.0))))
        if nearest > np.degrees(largest_tilt):
            return (
                f"the tool axis of point {k + 1} comes no nearer than {nearest:.1f} deg to the "
                "favourable direction, "
                f"expected {np.degrees(largest_tilt):.1f}; try wider ranges or a larger tilt"
            )
    turn = float(np.degrees(np.arccos(np.clip(axes[first] @ axes[first + 1], -1.0, 1.0))))
    return (
        f"no one setting holds the move from point {first + 1} to point {first + 2}, which turns "
        f"the tool axis by {turn:.1f} deg; split the path there or allow a larger tilt than "
        f"{np.degrees(largest_tilt):.1f} deg"
    )
