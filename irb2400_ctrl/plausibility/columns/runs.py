"""Stretches of a log in which a column keeps one value."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, true_stretches
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility.problem import LogProblem

Run = tuple[int, int]


def runs(values: Array, least: int) -> Iterator[Run]:
    """Stretches of at least so many samples of one value, as [start, stop)."""
    return stretches(np.diff(values) == 0.0, least)


def stretches(equal: Mask, least: int) -> Iterator[Run]:
    """Stretches of neighbours that are `equal`, as [start, stop) of their samples."""
    for start, stop in true_stretches(equal):
        if stop - start + 1 >= least:
            yield int(start), int(stop) + 1


def held(kind: str, what: str, log: Log, start: int, stop: int, j: int) -> LogProblem:
    """A column that keeps one value while its joint moves.

    Args:
        kind: of the problem; what: the quantity in words.
        log: it is a column of; start, stop: samples of the run, [start, stop); j: joint from 0.
    """
    return LogProblem(
        kind,
        f"the {what} of joint {j + 1} stands at one value from {log.time[start]:.2f} to "
        f"{log.time[stop - 1]:.2f} s while the joint moves",
        {"from_s": float(log.time[start]), "to_s": float(log.time[stop - 1])},
        (j + 1,),
    )
