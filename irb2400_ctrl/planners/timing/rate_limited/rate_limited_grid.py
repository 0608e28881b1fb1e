"""Grids for `RateLimitedLaw`: small cells where the acceleration builds up."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.cells import grid
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import ConstrainedOutputs
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.time_law import TimeLaw

# time in the first cell, as a part of the time in which the acceleration builds up; the next ones
# grow by a factor
_FIRST = 0.04
_GROWTH = 1.25
# smallest of them, as a part of the path: what is cut further has to stay above its rounding
_LEAST = 1e-10
# largest change of log x within a cell
_CHANGE = 0.35
# where the speed changes: cells passed within this part of the time in which the acceleration
# builds up
_PART = 1 / 4
# changes of log x below this are none
_STEADY = 0.02
# points that are not knots stay this part of the larger gap beside them away from others
_SLIVER = 0.05


def first_grid(path: JointPath, fastest: TimeLaw, outputs: ConstrainedOutputs, count: int) -> Array:
    """Knots, reversals, even steps; small steps at both ends, growing, and wherever the fastest
    motion changes by much.

    Args:
        path: the joint path.
        fastest: its time law with jumps.
        outputs: on the cells of that law.
        count: about how many even steps.
    """
    s = grid(path, count)
    jerk, ramp = outputs.building_up(np.full(len(outputs.h), fastest.x.max()))
    steps = [s]
    for end, side in ((0, 1.0), (-1, -1.0)):
        first = min(jerk[end] * (_FIRST * ramp[end]) ** 3 / 6, 1e-2 * np.diff(s)[end])
        first = max(first, _LEAST * path.length)
        growing = first * _GROWTH ** np.arange(
            np.ceil(np.log(path.length / 4 / first) / np.log(_GROWTH))
        )
        steps.append(s[end] + side * growing[growing * (_GROWTH - 1) < path.length / count])
    s = _without_slivers(np.unique(np.concatenate(steps)), path.knots)
    x = np.interp(s, fastest.s, fastest.x)
    change = np.abs(np.diff(np.log(np.maximum(x[1:-1], 1e-300))))
    return divided(
        s, np.concatenate([[1], np.clip(np.ceil(change / _CHANGE), 1, 20), [1]]).astype(int)
    )


def refined(law: RateLimitedLaw, outputs: ConstrainedOutputs) -> Array:
    """The grid of a law, cut so that no cell in which the speed changes takes long, for a closer
    solution."""
    _, ramp = outputs.building_up(np.maximum(law.x[:-1], law.x[1:]))
    change = np.zeros(len(ramp))
    change[1:-1] = np.abs(np.diff(np.log(law.x[1:-1])))
    busy = change > _STEADY
    busy[1:] |= busy[:-1].copy()
    busy[:-1] |= busy[1:].copy()
    parts = np.clip(
        np.ceil(np.maximum(np.diff(law.time) / (_PART * ramp), change / _CHANGE)), 1, 20
    )
    parts = np.where(busy, parts, 1).astype(int)
    parts[[0, -1]] = 1
    return divided(law.s, parts)


def _without_slivers(s: Array, knots: Array) -> Array:
    gap = np.diff(s)
    fixed = np.isin(s, knots)
    fixed[[0, 1, -2, -1]] = True
    near = np.minimum(gap[:-1], gap[1:]) < _SLIVER * np.maximum(gap[:-1], gap[1:])
    drop = np.flatnonzero(near & ~fixed[1:-1]) + 1
    # of neighbours only the first goes
    return np.delete(s, drop[np.diff(drop, prepend=-1) > 1])
