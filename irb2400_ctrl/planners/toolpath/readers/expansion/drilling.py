"""Hole-making cycles, expanded into the moves they stand for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.toolpath.readers.feed import Feed

# LinuxCNC: "rapid down to … 0.010 inch (0.254 mm) above", and the back-off of G73
BACK_OFF = 0.254e-3
MOST_STEPS = 10_000


@dataclass(frozen=True)
class HoleCycle:
    """One hole: heights are measured along the tool axis from the point that the file states."""

    kind: str
    """"drill" (rapid out), "peck" (out of the hole after each step), "chip" (a short way back after
    each step) or "bore" (feed out: boring, reaming, tapping)"""
    depth: float
    """how far below the point the bottom is [m]"""
    clearance: float
    """how far above the point the feed begins [m]"""
    retract: float
    """height left at the end; inf: the height the tool came from [m]"""
    steps: tuple[float, ...] = ()
    """depth of each step, the last one repeated [m]"""
    dwell: float = 0.0
    """at the bottom [s]"""
    feed: Feed | None = None
    """None: the feed in force"""
    name: str = "DRILL"
    assumed: str = ""
    """how the statement was read, where it can be read in two ways"""
    feed_out: Feed | None = None
    """of the way out of a bore; None: that of the way in"""


@dataclass(frozen=True)
class HoleMove:
    """A move to `position`; `dwell` seconds there; `out`: at the feed of the way out."""

    position: Array
    rapid: bool
    dwell: float = 0.0
    out: bool = False


def with_retract(cycle: HoleCycle, here: Array | None, point: Array, axis: Array) -> HoleCycle:
    """The cycle with the height it ends at, where that is the height the tool came from.

    Args:
        cycle: of the hole.
        here: where the tool is [m], shape (3,); None where that is not known.
        point: of the hole [m], shape (3,).
        axis: out of the hole, shape (3,).
    """
    if np.isfinite(cycle.retract):
        return cycle
    height = -np.inf if here is None else float((here - point) @ axis)
    return replace(cycle, retract=max(height, cycle.clearance))


def approach(cycle: HoleCycle, here: Array | None, point: Array, axis: Array) -> Iterator[HoleMove]:
    """Above the hole: up to the clearance first where the tool is lower, across, then down.

    Args:
        cycle: of the hole.
        here: where the tool is [m], shape (3,); None where that is not known.
        point: of the hole [m], shape (3,).
        axis: out of the hole, shape (3,).
    """
    above = point + cycle.clearance * axis
    if here is not None:
        height = float((here - point) @ axis)
        if height < cycle.clearance - 1e-9:
            here = here + (cycle.clearance - height) * axis
            height = cycle.clearance
            yield HoleMove(here, True)
        across = point + height * axis
        if np.linalg.norm(across - here) > 1e-9:
            yield HoleMove(across, True)
        if height <= cycle.clearance + 1e-9:
            return
    yield HoleMove(above, True)


def hole(cycle: HoleCycle, point: Array, axis: Array) -> Iterator[HoleMove]:
    """From the clearance to the bottom and out.

    Args:
        cycle: of the hole.
        point: of the hole [m], shape (3,).
        axis: out of the hole, shape (3,).
    """
    above = point + cycle.clearance * axis
    bottom = point - cycle.depth * axis
    reached = cycle.clearance
    for level in _levels(cycle)[:-1]:
        yield HoleMove(point + level * axis, False)
        if cycle.kind == "peck":
            yield HoleMove(above, True)
            yield HoleMove(point + min(level + BACK_OFF, cycle.clearance) * axis, True)
        else:
            yield HoleMove(point + min(level + BACK_OFF, reached) * axis, True)
        reached = level
    yield HoleMove(bottom, False, cycle.dwell)
    if cycle.kind == "bore":
        yield HoleMove(above, False, out=True)
        if cycle.retract > cycle.clearance + 1e-9:
            yield HoleMove(point + cycle.retract * axis, True)
    else:
        yield HoleMove(point + cycle.retract * axis, True)


def _levels(cycle: HoleCycle) -> list[float]:
    """Heights at which a step ends, falling, the bottom last [m]."""
    if cycle.kind not in {"peck", "chip"} or not cycle.steps:
        return [-cycle.depth]
    levels: list[float] = []
    level = cycle.clearance
    while level > -cycle.depth + 1e-9:
        step = cycle.steps[min(len(levels), len(cycle.steps) - 1)]
        if step <= 0 or len(levels) >= MOST_STEPS:
            raise InputError(
                f"{cycle.name}: a step of {1e3 * step:.3g} mm makes more than "
                f"{MOST_STEPS} steps in {1e3 * cycle.depth:.3g} mm; expected a larger step"
            )
        level = max(level - step, -cycle.depth)
        levels.append(level)
    return levels or [-cycle.depth]
