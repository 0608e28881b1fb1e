"""The two passes of `two_pass.c` in numpy, where there is no C compiler."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array

HARDLY = 1e14
"""a row whose factor of u is smaller than this part of the other bounds x alone"""
TOUCHING = 1e-12
"""rounding at an interval of a single point"""


@dataclass(frozen=True)
class Passed:
    """Result of the passes."""

    x: Array
    """sdot^2 at the grid points, shape (m + 1,); meaningless unless all cells are feasible"""
    infeasible_cell: int | None
    """cell at which no x is left, None on success"""
    low: Array
    high: Array
    """interval of x from which the end can be reached, shape (m + 1,)"""


def interpreted_two_pass(constraints: Array, h: Array, low: Array, high: Array) -> Passed:
    """`two_pass` with the same arguments, result and steps, some hundred times slower."""
    m = len(h)
    reach_low = np.zeros(m + 1)
    reach_high = np.zeros(m + 1)
    reach_low[m] = low[m]
    reach_high[m] = high[m]
    for i in range(m - 1, -1, -1):
        after = (reach_low[i + 1], reach_high[i + 1])
        found = _reach(constraints[i], h[i], (low[i], high[i]), after)
        if found is None:
            return Passed(np.zeros(m + 1), i, reach_low, reach_high)
        reach_low[i], reach_high[i] = found
    x = np.zeros(m + 1)
    x[0] = reach_high[0]
    for i in range(m):
        step = _fastest(constraints[i], h[i], x[i], reach_high[i + 1])
        x[i + 1] = max(x[i] + 2.0 * h[i] * step, reach_low[i + 1])
        # towards rest reach_high is 0 and what is left is the rounding of x[i]: relative to both
        if not x[i + 1] <= reach_high[i + 1] * (1.0 + 1e-9) + x[i] * 1e-12 + 1e-300:
            return Passed(x, i, reach_low, reach_high)
        x[i + 1] = min(x[i + 1], reach_high[i + 1])
    return Passed(x, None, reach_low, reach_high)


def _reach(
    rows: Array, h: float, box: tuple[float, float], after: tuple[float, float]
) -> tuple[float, float] | None:
    """Interval of x_i from which some u leads into the interval of x_i+1."""
    p, q, r = rows.T
    alone = np.abs(p) * HARDLY <= np.abs(q) * h
    if np.any(alone & (q == 0.0) & (r < 0.0)):
        return None
    above = alone & (q > 0.0)
    below = alone & (q < 0.0)
    top = float(np.min(r[above] / q[above], initial=box[1]))
    bottom = float(np.max(r[below] / q[below], initial=box[0]))
    if not bottom <= top:
        return None
    factor = 1.0 / (2.0 * h)
    used = ~alone
    lines = np.column_stack(
        (
            np.concatenate((p[used], [1.0, -1.0])),
            np.concatenate((r[used] / p[used], [after[1] * factor, after[0] * factor])),
            np.concatenate((q[used] / p[used], [factor, factor])),
        )
    )
    upper = _nearest_end(lines, bottom, top, from_high=True)
    if upper is None:
        return None
    lower = _nearest_end(lines, bottom, upper, from_high=False)
    return None if lower is None else (lower, upper)


def _nearest_end(lines: Array, low: float, high: float, *, from_high: bool) -> float | None:
    """End of {x in [low, high]: a u is left} nearest to the one started from; None when empty."""
    x = high if from_high else low
    for _ in range(100):
        gap, slope = _gap(lines, x)
        if not gap > 0.0:
            return x
        if not (slope > 0.0 if from_high else slope < 0.0):
            return None
        after = x - gap / slope
        if after < low if from_high else after > high:
            end = low if from_high else high
            if abs(after - end) > TOUCHING * (1.0 + abs(high)):
                return None
            after = end
        if after == x:
            return x
        x = after
    return x


def _gap(lines: Array, x: float) -> tuple[float, float]:
    """(largest lower bound of u) - (smallest upper bound of u) at x, and its slope."""
    u = lines[:, 1] - lines[:, 2] * x
    upper = np.where(lines[:, 0] > 0.0, u, np.inf)
    lower = np.where(lines[:, 0] < 0.0, u, -np.inf)
    high = int(np.argmin(upper))
    low = int(np.argmax(lower))
    return float(lower[low] - upper[high]), float(lines[high, 2] - lines[low, 2])


def _fastest(rows: Array, h: float, x: float, reach: float) -> float:
    """Largest u of a cell that starts at x and ends at most at `reach`."""
    p, q, r = rows.T
    bounding = (p > 0.0) & (np.abs(p) * HARDLY > np.abs(q) * h)
    bounds = (r[bounding] - q[bounding] * x) / p[bounding]
    return float(np.min(bounds, initial=(reach - x) / (2.0 * h)))
