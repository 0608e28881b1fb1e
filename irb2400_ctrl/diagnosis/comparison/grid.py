"""Places in the grid of a family's nonlinear parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array

KEPT = 2
"""how many of the best of a grid are scored with discrepancy"""
FURTHER_PEAKS = 6
"""how many further peaks are, where the best are of no plausible numbers (a resonance far too low
that swings the wrong way fits better than the true one while friction beside it is not found), and
of a transmission always: its own joint alone ranks a resonance that all others contradict first"""


def promising_places(gains: Array) -> list[int]:
    """Places worth a closer look, the best first, then other peaks along the grid.

    Args:
        gains: of all its points in their order, shape (g,).
    """
    best = np.argsort(-gains)[:KEPT]
    lower = np.concatenate([[-np.inf], gains, [-np.inf]])
    peaks = np.flatnonzero((gains > lower[:-2]) & (gains > lower[2:]))
    others = [place for place in peaks[np.argsort(-gains[peaks])] if place not in best]
    return [int(place) for place in (*best, *others[:FURTHER_PEAKS])]


def step_at(grid: Sequence[dict[str, float]], key: str, value: float) -> float:
    """Distance of a value of a grid to the nearer of its neighbours.

    Args:
        grid: points by name; key: one of the names.
        value: of a point there, in the unit of its field.
    """
    others = {point[key] for point in grid} - {value}
    return min(abs(other - value) for other in others)
