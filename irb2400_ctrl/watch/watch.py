"""`Watch`: an arm followed through its log, piece by piece as the samples come."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed
from irb2400_ctrl.watch.alarm import LEAST_BLOCKS, MONTH, Alarm, Cusum, Usual
from irb2400_ctrl.watch.baseline import BLOCK, Baseline
from irb2400_ctrl.watch.tracking import Tracked, Tracker

LEARN = 60.0
"""[s] of the log that are taken as sound"""
AROUND = 1.0
"""[s] before and after a block that its filters see"""
MOST_AT_ONCE = 60.0
"""[s] that are worked on together, where so much has come"""
SUSPECT = 20.0
"""[s] after a change that are diagnosed"""
BESIDE = 40.0
"""[s] before it that are diagnosed with them"""
FEW = 100
"""samples, of which fewer say nothing"""


@dataclass(frozen=True)
class Seen:
    """A block that was watched.

    Args:
        time: its middle [s].
        energy: of what is left, over the usual, shape (n,) [-]; NaN where a joint says nothing.
        torque: external torque, shape (n,) [Nm].
        sums: of the alarm, over its threshold, shape (n,) [-].
        alarms: that the block gives.
        tracked: frictions and load after it.
    """

    time: float
    energy: Array
    torque: Array
    sums: Array
    alarms: tuple[Alarm, ...]
    tracked: Tracked


@typed
@dataclass(repr=False)
class Watch:
    """Samples in, blocks and alarms out.

    Args:
        robot: the model; a file from `identify` knows most.
        learn: beginning of the log that is taken as sound [s].
        between: mean time between false alarms, all joints together [s of motion].
    """

    robot: Robot
    learn: float = LEARN
    between: float = MONTH
    baseline: Baseline | None = None
    seen: list[Seen] = field(default_factory=list)
    _samples: list[Log] = field(default_factory=list)
    _cusum: Cusum | None = None
    _tracker: Tracker | None = None
    _next: float = 0.0
    _first: float | None = None

    def __repr__(self) -> str:
        learned = "nothing learned yet" if self.baseline is None else f"{self.learn:g} s learned"
        return f"<Watch of {self.robot.name}: {learned}, {len(self.seen)} blocks seen>"

    @typed
    def feed(self, samples: Log) -> Iterator[Seen]:
        """Blocks that are complete with these samples.

        Raises:
            InputError: samples before those that came, or that do not fit the robot; a stretch to
            be learned that is not what its columns say.
        """
        if samples.n != self.robot.n:
            raise InputError(
                f"{samples.name}: found {samples.n} joints, expected the {self.robot.n} of "
                f"{self.robot.name}"
            )
        if self._samples and samples.time[0] <= self._samples[-1].time[-1]:
            raise InputError(
                f"{samples.name}: found samples of {samples.time[0]:g} s after those of "
                f"{self._samples[-1].time[-1]:g} s, expected later ones"
            )
        self._first = float(samples.time[0]) if self._first is None else self._first
        self._samples.append(samples)
        if self._cusum is None:
            if self.length < self.learn:
                return
            self._learn()
        yield from self._work()

    def _learn(self) -> None:
        record = _joined(self._samples)
        end = record.time[0] + self.learn
        sound = between(record, -np.inf, end)
        problem = log_problem(self.robot, sound)
        if problem is not None:
            # what fits nothing would be usual, and nothing after it an alarm
            raise InputError(
                f"{record.name}: the {self.learn:g} s to be learned are not understood: "
                f"{problem.says}; try `irb2400 log check`"
            )
        self.baseline = Baseline.of(self.robot, sound)
        usual = Usual.of(self.baseline.learned)
        self._cusum = Cusum(usual, self.between)
        self._tracker = Tracker(self.baseline, usual)
        self._next = float(np.ceil(end / BLOCK) * BLOCK)

    def _work(self) -> Iterator[Seen]:
        """All blocks whose surroundings are there."""
        while True:
            record = _joined(self._samples)
            last = record.time[-1] - AROUND
            if last > self._next:
                # what was not recorded is not watched
                came = record.time[np.searchsorted(record.time, self._next)]
                self._next = max(self._next, float(came // BLOCK * BLOCK))
            count = min(int((last - self._next) / BLOCK), round(MOST_AT_ONCE / BLOCK))
            if count < 1:
                return
            end = self._next + count * BLOCK
            rows = slice(*np.searchsorted(record.time, [self._next - AROUND, end + AROUND]))
            if rows.stop - rows.start >= FEW:
                yield from self._judged(part(record, rows), end)
            self._next = end
            # what a diagnosis may ask for stays
            oldest = end - SUSPECT - BESIDE - 2 * MOST_AT_ONCE
            first = min(int(np.searchsorted(record.time, oldest)), max(len(record.time) - FEW, 0))
            self._samples = [part(record, slice(first, None))]

    def _judged(self, record: Log, end: float) -> Iterator[Seen]:
        assert self.baseline is not None
        assert self._cusum is not None
        assert self._tracker is not None
        if record.duration < 2 * AROUND:
            return
        found, joints = self.baseline.judged(record)
        for time, energy, torque in zip(found.time, found.energy, found.torque, strict=True):
            came = np.searchsorted(record.time, [time - BLOCK / 2, time + BLOCK / 2])
            if not self._next < time < end or came[0] == came[1]:
                continue
            alarms = self._cusum.add(float(time), energy, torque)
            tracked = self._tracker.add([white.block(time) for white in joints], alarms)
            shown = Seen(
                float(time),
                energy / self._cusum.usual.energy,
                torque,
                self._cusum.sums / self._cusum.threshold,
                tuple(alarms),
                tracked,
            )
            self.seen.append(shown)
            yield shown

    @property
    def length(self) -> float:
        """From the first sample to the last [s]."""
        first = self._first
        return 0.0 if first is None else self.until - first

    @property
    def until(self) -> float:
        """Time of the last sample that came [s]."""
        return float(self._samples[-1].time[-1]) if self._samples else 0.0

    @property
    def band(self) -> Array:
        """Three standard deviations of the external torque while nothing was wrong, shape (n,)
        [Nm]; NaN where the learned stretch does not show a joint."""
        if self.baseline is None:
            return np.full(self.robot.n, np.nan)
        torque = self.baseline.learned.torque
        shown = np.isfinite(torque).sum(axis=0) >= LEAST_BLOCKS
        count = np.maximum(np.isfinite(torque).sum(axis=0), 1)
        return np.where(shown, 3.0 * np.sqrt(np.nansum(torque**2, axis=0) / count), np.nan)

    @property
    def silent(self) -> bool:
        """Whether no joint has said anything since the learned stretch: the arm stood."""
        return not any(np.isfinite(seen.energy).any() for seen in self.seen)

    def lately(self, seconds: float = LEARN) -> Log:
        """The last of the samples that came, at most so many [s]."""
        return between(_joined(self._samples), self.until - seconds, np.inf)

    def diagnosed(self, alarm: Alarm) -> Diagnosis:
        """The seconds before and after the alarm's beginning as one record: what begins there is
        what changed."""
        record = _joined(self._samples)
        return diagnose(self.robot, between(record, alarm.since - BESIDE, alarm.since + SUSPECT))

    def summary(self) -> dict[str, Any]:
        """What was watched, for watch.json."""
        torques = np.array([seen.torque for seen in self.seen]).reshape(-1, self.robot.n)
        largest = np.abs(np.nan_to_num(torques)).max(axis=0, initial=0.0)
        return {
            "schema_version": 1,
            "robot": self.robot.name,
            "learned_s": self.learn,
            "watched_s": BLOCK * len(self.seen),
            "false_alarm_after_s": self.between,
            "external_torque_band_Nm": self.band,
            "largest_external_torque_Nm": largest,
            "tracked": self.seen[-1].tracked.to_json() if self.seen else None,
            "alarms": [alarm.to_json() for seen in self.seen for alarm in seen.alarms],
        }


def between(log: Log, start: float, end: float) -> Log:
    """The samples from `start` to `end` [s], on a view of the log's arrays where it can be.

    Args:
        log: samples in their order.
        start: first time that counts [s].
        end: first time that does not [s].
    """
    return part(log, slice(*np.searchsorted(log.time, [start, end])))


def part(log: Log, rows: slice) -> Log:
    """Some rows of a log, on a view of its arrays."""
    parts: dict[str, Any] = {
        name: None if (value := getattr(log, name)) is None else value[rows]
        for name in ("q", "tau", "q_ref")
    }
    return Log(log.time[rows], name=log.name, **parts)


def _joined(parts: list[Log]) -> Log:
    """Parts of one log as one."""
    if len(parts) == 1:
        return parts[0]
    stacked: dict[str, Any] = {
        name: None
        if any(getattr(part, name) is None for part in parts)
        else np.concatenate([getattr(part, name) for part in parts])
        for name in ("q", "tau", "q_ref")
    }
    return Log(np.concatenate([part.time for part in parts]), name=parts[0].name, **stacked)
