"""Stamps of a host that got samples in groups: several at once, then none for a while."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask

FEWEST = 20
"""steps of which something is told"""
BETWEEN = 2.0
"""times the median step: one from a group to the next"""
OFTEN = 0.05
"""share of the steps that are such, at least"""
IN_GROUPS = 0.7
"""median over mean step of the stamps, below which the median may be the time between two samples
of a group, and the period that of all"""
CLEARLY = 0.5
"""the same below which it is: two of five samples lost in bursts leave 0.6"""


def grouped(stamps: Array, *, clearly: bool = False) -> bool:
    """Whether a host may have got the samples in groups: not where a few pauses alone are long.

    Args:
        stamps: shape (m,) [s]; clearly: whether it must be so, no loss of many samples.
    """
    steps = np.diff(stamps)
    if len(steps) < FEWEST:
        return False
    often = np.mean(_between(steps)) > OFTEN
    share = CLEARLY if clearly else IN_GROUPS
    return bool(often and np.median(steps) < share * np.mean(steps))


def apart(stamps: Array) -> tuple[float, float]:
    """Usual time between two samples of a group, and from a group to the next [s]."""
    steps = np.diff(stamps)
    return float(np.median(steps)), float(np.median(steps[_between(steps)]))


def _between(steps: Array) -> Mask:
    """Which steps are from a group to the next."""
    return np.asarray(steps > BETWEEN * np.median(steps))


def stamps_apart(stamps: Array) -> Array:
    """Rising stamps that differ from these by the order of samples of one instant alone.

    The stamps themselves where none are alike, or where the clock goes back.
    """
    steps = np.diff(stamps)
    if len(steps) < FEWEST or not (steps == 0.0).any() or (steps < 0.0).any():
        return stamps
    first = np.r_[True, steps > 0.0]
    starts = stamps[first]
    if len(starts) < FEWEST:
        return stamps
    group = np.cumsum(first) - 1
    room = np.diff(starts)
    room = np.r_[room, np.median(room)]
    place = np.arange(len(stamps)) - np.flatnonzero(first)[group]
    apart = np.asarray(stamps + 0.5 * room[group] * place / np.bincount(group)[group])
    return apart if (np.diff(apart) > 0.0).all() else stamps
