"""Why nothing leads through a ladder: the place, the axis, and how far beyond its range."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, less_turns
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.planners.redundancy.ladder_graph import FREE_SHIFTS, Ladder
from irb2400_ctrl.planners.redundancy.ladder_moves import LARGEST_STEP

OTHER_UNIT = 50.0
"""[m] so far beyond its reach no part is placed by mistake, but by another unit"""
FREE = "free the tool rotation"
TOOL = "look at the tool of the robot file, whose z axis has to point out of the spindle"


def refusal(ladder: Ladder, names: Integers) -> UnreachableError:
    """The first station without any configuration, or where every continuous motion breaks.

    Args:
        names: index of the way-point that each station leads to, shape (n,).
    """
    for i in range(len(ladder.u)):
        if not ladder.allowed(i).any():
            return _no_configuration(ladder, i, int(names[i]) + 1)
    shifts = FREE_SHIFTS if len(ladder.rotation) > 1 else (0,)
    _, back = ladder.sweep(shifts, level=None)
    at = min(len(back), len(ladder.u) - 1)
    point = int(names[at]) + 1
    touching = _blocking_collision(ladder, shifts, at, point)
    if touching is not None:
        return touching
    blocked = _blocking_axis(ladder, shifts, at)
    obstacle = "" if ladder.crowd is None else "a collision or "
    if blocked is None:
        return UnreachableError(
            f"no continuous motion reaches point {point}: every configuration that reaches the "
            f"points before it meets {obstacle}a singularity there; split the path, or move the "
            "work frame"
        )
    axis, needed = blocked
    low, high = np.degrees([ladder.model.robot.q_min[axis], ladder.model.robot.q_max[axis]])
    return UnreachableError(
        f"no continuous motion reaches point {point}: axis {axis + 1} runs out there, it would "
        f"need {np.degrees(needed):.1f} deg, range {low:.0f} to {high:.0f} deg; every other "
        "configuration that reaches the points before it ends earlier or there, too; split the "
        "path, or move the work frame"
    )


def _no_configuration(ladder: Ladder, i: int, point: int) -> UnreachableError:
    """A station that the arm does not reach at all."""
    boxed = ladder.inside(i).any(axis=2)
    if ladder.crowd is not None and boxed.any():
        return ladder.crowd.refusal(ladder.q[i][boxed], i, point)
    robot = ladder.model.robot
    q = ladder.q[i].reshape(-1, robot.n)
    if not np.isfinite(q).any():
        gap = float(ladder.overreach[i].min())
        advice = "move the work frame closer, or choose another tool axis"
        if gap > OTHER_UNIT:
            advice = "are its millimetres taken for metres? Lengths are in m in Python"
        return UnreachableError(
            f"point {point} is out of reach: the wrist centre lies {1e3 * gap:.1f} mm beyond the "
            f"arm; {advice}"
        )
    low = robot.q_min + ladder.inset
    high = robot.q_max - ladder.inset
    excess = np.maximum(np.maximum(low - q, q - high), 0.0)
    # axes 4 and 6 fit somewhere within whole turns; the others decide unless only they are outside
    best = int(np.nanargmin(excess.max(axis=1)))
    axis = int(np.argmax(excess[best]))
    ends = np.degrees([low[axis], high[axis]])
    kept = f"its range less {np.degrees(ladder.inset):.1g} deg at each end"
    return UnreachableError(
        f"point {point} is out of the joint box: axis {axis + 1} would need "
        f"{np.degrees(q[best, axis]):.1f} deg, {np.degrees(excess[best, axis]):.1f} deg "
        f"beyond {ends[0]:.1f} to {ends[1]:.1f} deg ({kept}){_whichever(ladder)}; move the work "
        "frame (irb2400 place looks for one) or " + (FREE if len(ladder.rotation) == 1 else TOOL)
    )


def _whichever(ladder: Ladder) -> str:
    return "" if len(ladder.rotation) == 1 else ", and more at every other rotation about the tool"


def _blocking_collision(
    ladder: Ladder, shifts: tuple[int, ...], at: int, point: int
) -> UnreachableError | None:
    """What is in the way at a station, if a motion would lead past it without the collisions."""
    if ladder.crowd is None:
        return None
    touching = ladder.inside(at).any(axis=2) & ~ladder.crowd.free(at)
    value, _ = replace(ladder, crowd=None).sweep(shifts, level=None)
    if not (touching.any() and (value > 0).any()):
        return None
    return ladder.crowd.blocked(ladder.q[at][touching], at, point)


def _blocking_axis(ladder: Ladder, shifts: tuple[int, ...], at: int) -> tuple[int, float] | None:
    """The axis that a motion up to the station before has to take least beyond its range to go on,
    and its angle there [rad]; None where every motion breaks at a singularity."""
    value, _ = ladder.sweep(shifts, level=None, stations=at)
    row, branch, turn = np.nonzero(value > 0)
    if not len(row):
        return None
    robot = ladder.model.robot
    q = ladder.q[at - 1, row, branch].copy()
    q[:, ladder.wound] += 2 * np.pi * ladder.turns[turn]
    best = np.inf
    found: tuple[int, float] | None = None
    for shift in shifts:
        there = ladder.q[at, (row + shift) % len(ladder.rotation), branch]
        step = less_turns(there - q)
        with np.errstate(invalid="ignore"):
            joined = (np.abs(step) < LARGEST_STEP).all(axis=1)
        reached: Array = (q + step)[joined]
        excess = np.maximum(
            robot.q_min + ladder.inset - reached, reached - robot.q_max + ladder.inset
        )
        if len(reached) and excess.max(axis=1).min() < best:
            k = int(np.argmin(excess.max(axis=1)))
            axis = int(np.argmax(excess[k]))
            best = float(excess[k, axis])
            found = axis, float(reached[k, axis])
    return found
