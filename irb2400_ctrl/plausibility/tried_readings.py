"""Readings of one log, tried on top of each other, and what each of them costs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility.criteria import (
    at_others_cost,
    clearly_better,
    leaves_half,
    sound,
)
from irb2400_ctrl.plausibility.evidence import MISFITS, Fit, Nominal
from irb2400_ctrl.plausibility.reading import (
    Reading,
    as_labelled,
    motion_readings,
    torque_readings,
)
from irb2400_ctrl.plausibility.rows import Rows, Slow
from irb2400_ctrl.plausibility.scales import scale_readings

SHARP_GAIN = 40.0
"""of six joints: twice the log evidence, each reading with the misfit it supports, by which another
reading of one joint must be better where the labelled one is not bad; of 140 sound logs it was 30
at most"""
THIN = 3
"""every third row is enough to sort the readings"""
FINALISTS = 4
"""readings that are then compared on all rows"""
FEW_MOTIONS = 8
EVERY_MOTION = 120
"""whose columns are kept, on all rows and on every third of them"""
SINGLE = ("angle_unit", "angle_sign", "axis_sign", "torque_sign", "coupling", "angle_zero")
"""what is asked of each joint alone with a sharper misfit"""
RESTS = 1e-3
"""[rad] of travel as labelled below which a joint rests, whatever the unit"""
BEYOND = 2.0
"""times its range that a joint may go through as it is read"""
DELAYS = (-1.0, -0.5, -0.3, -0.2, -0.1, 0.1, 0.2, 0.3, 0.5, 1.0)
"""[s] shifts of the torques against the motion that are tried"""


class TriedReadings:
    """Readings of one log, tried on top of each other."""

    def __init__(
        self, nominal: Nominal, log: Log, rows: Rows, keep: int = 1, motions: int = FEW_MOTIONS
    ) -> None:
        """Nothing is tried yet.

        Args:
            nominal: the yardstick; log: as it is labelled; rows: of it.
            keep: every so many of the rows are compared.
            motions: of so many the columns are kept.
        """
        self._nominal = nominal
        self._log = log
        self._keep = keep
        self._motions_kept = motions
        self._rows = {0.0: rows.thinned(keep)}
        self._columns: dict[bytes, tuple[Array, Array]] = {}

    def rows(self, reading: Reading) -> Rows | None:
        """The log as a reading takes it."""
        delay = reading.delay
        if delay not in self._rows:
            found = None if self._slow is None else self._slow.rows(delay)
            if found is None:
                return None
            self._rows[delay] = found.thinned(self._keep)
        return self._rows[delay].read_as(reading)

    def fit(self, reading: Reading) -> Fit:
        """How well a reading is explained; infinitely badly where nothing is left of it."""
        rows = self.rows(reading)
        if rows is None or not np.isfinite(rows.qdd).all():
            return Fit(np.inf, np.inf, np.ones(self._nominal.robot.n))
        found = self._nominal.explained(rows, self.columns_of(reading, rows))
        return replace(found, cost=found.cost + reading.price)

    def better(self, first: Reading, fit: Fit) -> tuple[Reading, Fit] | None:
        """The best reading on top of `first`, if it is better by far."""
        quick = self._quick
        tried: list[tuple[float, int, Reading]] = []
        for several in (quick._torques(first), quick._motions()):
            for one in several:
                reading = one.after(first) if first.kind else one
                tried.append((quick.fit(reading).cost, len(tried), reading))
            best = min(tried)[2]
            # a factor of all that explains all is not found by chance; a sign, an order, a factor
            # of one joint may be another's
            every = best.kind == "torque_scale" and not best.joints
            if every and sound(self.fit(best), self._nominal.robot.n):
                break
        fits = [(reading, self.fit(reading)) for _, _, reading in sorted(tried)[:FINALISTS]]
        reading, found = min(fits, key=lambda pair: pair[1].cost)
        hidden = reading.kind == "torque_scale"
        return (reading, found) if clearly_better(found, fit, hidden) else None

    def misread(self, plain: Reading, labelled: Fit) -> tuple[Reading, Fit] | None:
        """A unit, sign or coupling of one joint that explains a log far better than its label does.

        On a joint that hardly loads the others even a wrong unit fits within the misfit of a crude
        model; the same model leaves far less with the right one (`Nominal.sharp_cost`).
        """
        robot = self._nominal.robot
        if not np.isfinite(labelled.cost):
            return None
        every = [*motion_readings(robot), *torque_readings(robot)]
        single = [r for r in every if len(r.joints) == 1 and r.kind in SINGLE and self._shows(r)]
        costs = [self._quick.sharp_cost(reading, (MISFITS[-2],)) for reading in single]
        best = single[int(np.argmin(costs))]
        gain = self.sharp_cost(plain) - self.sharp_cost(best)
        if gain < SHARP_GAIN * robot.n / 6.0:
            return None
        found = self.fit(best)
        told = leaves_half(found, labelled) and not at_others_cost(best, found, labelled)
        return (best, found) if told else None

    def sharp_cost(self, reading: Reading, misfits: tuple[float, ...] = MISFITS) -> float:
        """Cost of a reading with the misfit that it supports; infinite where nothing is left."""
        rows = self.rows(reading)
        if rows is None or not np.isfinite(rows.qdd).all():
            return np.inf
        columns = self.columns_of(reading, rows)
        return self._nominal.sharp_cost(rows, columns, misfits) + reading.price

    def _torques(self, first: Reading) -> Iterator[Reading]:
        yield from torque_readings(self._nominal.robot)
        rows = self.rows(first)
        if rows is not None:
            yield from scale_readings(self._nominal, rows, self.columns_of(first, rows))

    def _motions(self) -> Iterator[Reading]:
        robot = self._nominal.robot
        yield from filter(self._shows, motion_readings(robot))
        plain = as_labelled(robot.n)
        for delay in DELAYS:
            says = f"torques look {abs(delay):.1f} s {'behind' if delay > 0 else 'ahead of'} the "
            yield replace(
                plain,
                kind="delay",
                says=says + "motion they belong to",
                delay=delay,
                fits={"delay_s": delay},
            )

    def _shows(self, reading: Reading) -> bool:
        """Whether the log can say that the angles are to be read so: not the one of a single joint
        that rests, nor such that a joint leaves its range by far which it keeps as labelled."""
        if reading.keeps_motion:
            return True
        travel = self._travel
        room = self._nominal.robot.q_max - self._nominal.robot.q_min
        read = np.ptp(reading.angles @ self._turned, axis=1)
        if ((read > BEYOND * room) & (travel <= room)).any():
            return False
        if len(reading.joints) != 1:
            return True
        return bool(travel[reading.joints[0] - 1] > RESTS)

    @cached_property
    def _travel(self) -> Array:
        """Of each joint as labelled, shape (n,) [rad]."""
        return np.asarray(np.ptp(self._turned, axis=1))

    @cached_property
    def _turned(self) -> Array:
        """The angles, a joint's samples side by side, shape (n, m) [rad]."""
        return np.ascontiguousarray(self._log.q.T)

    @cached_property
    def _quick(self) -> TriedReadings:
        """The same on few rows, which keeps the columns of every motion that is tried."""
        return TriedReadings(self._nominal, self._log, self._rows[0.0], THIN, EVERY_MOTION)

    @cached_property
    def _slow(self) -> Slow | None:
        """The log of which every delay takes its rows."""
        return Slow.of(self._log)

    def columns_of(self, reading: Reading, rows: Rows) -> tuple[Array, Array]:
        """As of `Nominal.columns`; what was asked last is kept."""
        key = reading.angles.tobytes() + reading.offset.tobytes()
        key += np.array([reading.clock, reading.delay]).tobytes()
        if key not in self._columns:
            if len(self._columns) > self._motions_kept:
                self._columns.clear()
            self._columns[key] = self._nominal.columns(rows)
        return self._columns[key]
