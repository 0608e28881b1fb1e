"""Stamps of a host that got samples in groups: several at once, then none for a while."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array

FEWEST = 20
"""steps of which something is told"""
IN_GROUPS = 0.7
"""median over mean step of the stamps, below which the median may be the time between two samples
of a group, and the period that of all"""


def grouped(stamps: Array) -> bool:
    """Whether a host may have got the samples in groups."""
    steps = np.diff(stamps)
    return len(steps) >= FEWEST and float(np.median(steps)) < IN_GROUPS * float(np.mean(steps))


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
