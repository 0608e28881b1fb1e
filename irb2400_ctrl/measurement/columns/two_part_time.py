"""A time in two columns: whole seconds, and what is beyond them in nanoseconds (stamps of ROS),
microseconds (EGM, `timeval`) or milliseconds."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.table import Table

_SECONDS = re.compile(r"(?P<of>.*?)(?P<word>secs?|seconds)", re.IGNORECASE)
_BEYOND = {
    10**9: ("nanosec", "nsec", "nsecs", "nanosecs", "nanoseconds"),
    10**6: ("microsec", "usec", "usecs", "microsecs", "microseconds"),
    10**3: ("millisec", "msec", "msecs", "millisecs", "milliseconds"),
}
"""counts a second -> words for them"""
MOSTLY = 0.5
"""share of the rows whose stamp is later than the one before, of a stamp that is filled in"""
COUNTED = {10**9: "nanoseconds", 10**6: "microseconds", 10**3: "milliseconds"}


class TimePair(NamedTuple):
    """The columns of a time in two parts: of whole seconds, of what is beyond them, and how many
    counts of that a second has."""

    seconds: str
    beyond: str
    counts: int = 10**9


def joined_time(table: Table) -> Table:
    """The table with both columns as one of seconds since the first stamp, `time_s`.

    Args:
        table: as it was read; without such a pair, or with several, it is returned as it is.
    """
    pair = time_pair(table.columns)
    return table if pair is None else joined(table, pair, "time_s")


def time_pair(names: Iterable[str]) -> TimePair | None:
    """The columns of whole seconds and of what is beyond them, where one pair is there."""
    by_name = {name.lower(): name for name in names}
    pairs = []
    for name in by_name.values():
        found = _SECONDS.fullmatch(name)
        if found is not None:
            beyond = {
                f"{found['of']}{word}".lower(): counts
                for counts, words in _BEYOND.items()
                for word in words
            }
            pairs += [
                TimePair(name, by_name[other], counts)
                for other, counts in beyond.items()
                if other in by_name
            ]
    # the stamp of the message's header, where other stamps stand beside it
    stamps = [pair for pair in pairs if "stamp" in pair.seconds.lower()]
    chosen = stamps if len(stamps) == 1 else pairs
    return chosen[0] if len(chosen) == 1 else None


def stamped(table: Table) -> bool:
    """Whether messages carry the stamp of when they were sampled, as two columns that are filled
    in: what stands beside it is when a recorder got them."""
    pair = time_pair(table.columns)
    if pair is None or "stamp" not in pair.seconds.lower():
        return False
    return filled_in(table.columns[pair.seconds] + table.columns[pair.beyond] / pair.counts)


def filled_in(stamps: Array) -> bool:
    """Whether a driver has filled in the stamps of its messages: many leave them at zero."""
    return len(stamps) > 1 and bool(np.mean(np.diff(stamps) > 0.0) > MOSTLY)


def joined(table: Table, pair: TimePair, into: str) -> Table:
    """The table with these two columns as one.

    Args:
        table: as read.
        pair: the columns.
        into: name of the new column [s].

    Raises:
        InputError: what is beyond the seconds is below zero, or a second and more.
    """
    whole = table.columns[pair.seconds]
    beyond = table.columns[pair.beyond]
    wrong = np.flatnonzero((beyond < 0) | (beyond >= pair.counts))
    if len(wrong):
        raise InputError(
            f"{table.path}: {pair.beyond} is {beyond[wrong[0]]:.10g} in {table.place(wrong[0])}, "
            f"expected {COUNTED[pair.counts]} beyond {pair.seconds}, 0 to {pair.counts - 1:,}"
        )
    # whole seconds first: counted from 1970, both in one number would lose the last digits
    start = whole[np.isfinite(whole)][:1]
    time = (whole - start if len(start) else whole) + beyond / pair.counts
    others = {k: v for k, v in table.columns.items() if k not in {pair.seconds, pair.beyond}}
    return replace(table, columns={into: time, **others})
