"""A time in two columns: whole seconds, and nanoseconds beyond them, as stamps of ROS."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.table import Table

_SECONDS = re.compile(r"(?P<of>.*?)(?P<word>secs?|seconds)", re.IGNORECASE)
_BEYOND = ("nanosec", "nsec", "nsecs", "nanosecs", "nanoseconds")
SECOND = 10**9


def joined_time(table: Table) -> Table:
    """The table with both columns as one of seconds since the first stamp, `time_s`.

    Args:
        table: as it was read; without such a pair, or with several, it is returned as it is.
    """
    pair = time_pair(table.columns)
    return table if pair is None else joined(table, *pair, "time_s")


def time_pair(names: Iterable[str]) -> tuple[str, str] | None:
    """The columns of whole seconds and of nanoseconds beyond them, where one pair is there."""
    by_name = {name.lower(): name for name in names}
    pairs = []
    for name in by_name.values():
        found = _SECONDS.fullmatch(name)
        if found is not None:
            beyond = [f"{found['of']}{word}".lower() for word in _BEYOND]
            pairs += [(name, by_name[other]) for other in beyond if other in by_name]
    # the stamp of the message's header, where other stamps stand beside it
    stamps = [pair for pair in pairs if "stamp" in pair[0].lower()]
    chosen = stamps if len(stamps) == 1 else pairs
    return chosen[0] if len(chosen) == 1 else None


def joined(table: Table, seconds: str, nanoseconds: str, into: str) -> Table:
    """The table with these two columns as one.

    Args:
        table: as read.
        seconds: name of that column [s].
        nanoseconds: name of that column [ns].
        into: name of the new column [s].

    Raises:
        InputError: nanoseconds below zero or of a second and more.
    """
    whole = table.columns[seconds]
    beyond = table.columns[nanoseconds]
    wrong = np.flatnonzero((beyond < 0) | (beyond >= SECOND))
    if len(wrong):
        raise InputError(
            f"{table.path}: {nanoseconds} is {beyond[wrong[0]]:.10g} in {table.place(wrong[0])}, "
            f"expected nanoseconds beyond {seconds}, 0 to 999,999,999"
        )
    # whole seconds first: counted from 1970, both in one number would lose the last digits
    start = whole[np.isfinite(whole)][:1]
    time = (whole - start if len(start) else whole) + beyond / SECOND
    others = {k: v for k, v in table.columns.items() if k not in {seconds, nanoseconds}}
    return replace(table, columns={into: time, **others})
