"""Several logs of one arm as one: prepared each for itself, then put one after another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.measurement.uniform import MAX_RATE, MIN_GRID, Kept, LowPass, Recorders

PAUSE = 1.0
"""[s] between two logs on the common clock"""
SEAM = 2
"""first rows of a log whose neighbours before belong to another one"""


@dataclass(frozen=True)
class LowPassOfEach(LowPass):
    """The common low-pass on every log for itself: nothing reaches over a seam.

    Args:
        starts: first sample of each log; each: its own low-pass.
    """

    starts: tuple[int, ...] = (0,)
    each: tuple[LowPass, ...] = ()

    def _parts(self, length: int) -> Iterator[tuple[LowPass, slice]]:
        for own, *ends in zip(self.each, self.starts, (*self.starts[1:], length), strict=True):
            yield own, slice(*ends)

    def __call__(self, signal: Array, recorders: Recorders = (None,)) -> Array:
        """`recorders`: of each log, or one None for all."""
        each = [None] * len(self.each) if tuple(recorders) == (None,) else recorders
        parts = zip(self._parts(len(signal)), each, strict=True)
        return np.concatenate([own(signal[part], (recorder,)) for (own, part), recorder in parts])

    def instants(self, signal: npt.NDArray[Kept]) -> npt.NDArray[Kept]:
        return np.concatenate(
            [own.instants(signal[part]) for own, part in self._parts(len(signal))]
        )


def prepare_together(logs: Sequence[Log]) -> PreparedLog:
    """One or several logs of one arm, prepared on one grid.

    Each log keeps its own time base, smoothing and ends; on the common clock they follow each other
    with a pause. `PreparedLog.starts` says where each begins.

    Raises:
        InputError: no log, different numbers of joints, one is too short.
    """
    if not logs:
        raise InputError("found no log, expected at least one")
    if len(logs) == 1:
        return prepare(logs[0])
    if len({log.n for log in logs}) > 1:
        counts = ", ".join(f"{log.name}: {log.n}" for log in logs)
        raise InputError(f"found logs of different numbers of joints ({counts})")
    rate = max(float(np.clip(log.rate, MIN_GRID, MAX_RATE)) for log in logs)
    rate = round(rate) if abs(rate - round(rate)) < 0.05 * rate else rate
    return joined([prepare(log, rate) for log in logs])


def joined(motions: Sequence[PreparedLog]) -> PreparedLog:
    """Prepared logs of one step, one after another."""
    first = motions[0]
    counts = [len(motion.time) for motion in motions]
    starts = tuple(int(v) for v in np.cumsum([0, *counts[:-1]]))
    shifts = [0.0]
    for before, after in pairwise(motions):
        shifts.append(shifts[-1] + before.time[-1] + PAUSE - after.time[0])

    def stacked(name: str) -> Any:
        return np.concatenate([getattr(motion, name) for motion in motions])

    known_rows = [np.array(motion.row_known) for motion in motions]
    for rows in known_rows[1:]:
        rows[:SEAM] = False
    weights = np.array(counts)[:, None] / sum(counts)
    follow = np.array([motion.follow_error**2 for motion in motions])
    signals = ("q", "qd", "qdd", "qddd", "qdddd", "tau", "tau_smooth", "known")
    parts: dict[str, Any] = {name: stacked(name) for name in signals}
    return replace(
        first,
        name=f"{len(motions)} logs",
        time=np.concatenate([m.time + s for m, s in zip(motions, shifts, strict=True)]),
        **parts,
        instrumented=all(motion.instrumented for motion in motions),
        disobeying=tuple(sorted({j for motion in motions for j in motion.disobeying})),
        held=tuple(dict.fromkeys(said for motion in motions for said in motion.held)),
        by_speed=any(motion.by_speed for motion in motions),
        follow_error=np.sqrt((weights * follow).sum(axis=0)),
        low_pass=LowPassOfEach(
            first.low_pass.cutoff,
            first.step,
            starts=starts,
            each=tuple(motion.low_pass for motion in motions),
        ),
        row_time=np.concatenate([m.row_time + s for m, s in zip(motions, shifts, strict=True)]),
        row_known=np.concatenate(known_rows),
        starts=starts,
        names=tuple(motion.name for motion in motions),
        recorders=tuple(recorder for motion in motions for recorder in motion.recorders),
    )
