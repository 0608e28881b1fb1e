"""Times as clocks and calendars write them: `2024-05-04 12:00:00.008`, `12:00:00,008`."""

from __future__ import annotations

import re

import numpy as np

from irb2400_ctrl.arrays import Array

DAY = 86_400.0
"""[s]"""
_CLOCK = re.compile(
    r"(?:[\w./-]{8,11}[T ]\s*|\d+ days? )?(?P<hours>[01]?\d|2[0-3]):(?P<minutes>[0-5]\d):"
    r"(?P<seconds>[0-5]\d(?:[.,:]\d+)?)\s*(?:Z|UTC|[+-]\d\d:?\d\d)?"
)


def seconds_of_day(cell: str) -> float | None:
    """Of a time of day, with or without its date [s]; None where the cell is none.

    The date is not read: a log of an arm lasts less than a day.
    """
    found = _CLOCK.fullmatch(cell.strip().strip('"').strip())
    if found is None:
        return None
    seconds = re.sub("[,:]", ".", found["seconds"])
    return 3600.0 * int(found["hours"]) + 60.0 * int(found["minutes"]) + float(seconds)


class Midnights:
    """Times of day that go on beyond midnight, piece after piece."""

    def __init__(self) -> None:
        self._days = 0
        self._last = np.nan

    def __call__(self, times: Array) -> Array:
        """The next piece [s], (m,), counted from the midnight before the first."""
        steps = np.diff(times, prepend=self._last)
        days = self._days + np.cumsum(steps < -DAY / 2)
        if len(times):
            self._days = int(days[-1])
            self._last = float(times[-1])
        return np.asarray(times + DAY * days)
