"""Times as clocks and calendars write them: `2024-05-04 12:00:00.008`, `12:00:00,008`, `1:00:00.008
PM`, minutes and seconds of a spreadsheet (`00:00.008`), durations of MATLAB (`0.008 sec`)."""

from __future__ import annotations

import re

import numpy as np

from irb2400_ctrl.arrays import Array

DAY = 86_400.0
"""[s]"""
_CLOCK = re.compile(
    r"(?:[\w./-]{8,11}[T _/-]\s*|\d+ days? )?(?P<hours>[01]?\d|2[0-3]):(?P<minutes>[0-5]\d):"
    r"(?P<seconds>[0-5]\d(?:[.,:]\d+)?)\s*(?:(?P<half>[AP])M|Z|UTC|[+-]\d\d:?\d\d)?",
    re.IGNORECASE,
)
_MINUTES = re.compile(r"(?P<minutes>[0-5]?\d):(?P<seconds>[0-5]\d[.,]\d+)")
_DURATION = re.compile(r"(?P<seconds>\d+(?:[.,]\d+)?(?:e[+-]?\d+)?) ?(?:s|sec)", re.IGNORECASE)


def seconds_of_day(cell: str) -> float | None:
    """Of a time of day, with or without its date [s]; None where the cell is none.

    The date is not read: a log of an arm lasts less than a day.
    """
    text = cell.strip().strip('"').strip()
    matches = (form.fullmatch(text) for form in (_CLOCK, _MINUTES, _DURATION))
    told = next((match.groupdict() for match in matches if match is not None), None)
    if told is None:
        return None
    hours = int(told.get("hours", 0))
    if told.get("half"):
        hours = hours % 12 + 12 * (told["half"] in "Pp")
    seconds = float(re.sub("[,:]", ".", told["seconds"]))
    return 3600.0 * hours + 60.0 * int(told.get("minutes", 0)) + seconds


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
