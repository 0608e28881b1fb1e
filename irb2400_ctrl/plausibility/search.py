"""Which reading of a log's columns a robot's model explains, before any effect is tried."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility.balancer import beside_a_balancer
from irb2400_ctrl.plausibility.columns.jumps import MOVES
from irb2400_ctrl.plausibility.coupled_wrist import beside_a_coupled_wrist
from irb2400_ctrl.plausibility.criteria import (
    FITS_PRICE,
    MARGIN,
    PUSHED,
    at_others_cost,
    clearly_better,
    lost,
    nearly,
    only_one_off,
    own,
    sound,
    strange,
)
from irb2400_ctrl.plausibility.evidence import MISFITS, Fit, Nominal
from irb2400_ctrl.plausibility.mounting import mounting_problem
from irb2400_ctrl.plausibility.over_time import disagreement
from irb2400_ctrl.plausibility.parts import best_part, hold_no_friction
from irb2400_ctrl.plausibility.problem import LogProblem
from irb2400_ctrl.plausibility.pushed import pushed
from irb2400_ctrl.plausibility.reading import (
    Reading,
    as_labelled,
    motion_readings,
    torque_readings,
)
from irb2400_ctrl.plausibility.rival_signs import with_its_rival
from irb2400_ctrl.plausibility.rows import Rows, rows_of
from irb2400_ctrl.plausibility.scales import scale_readings
from irb2400_ctrl.plausibility.travel import fastest
from irb2400_ctrl.robot import Robot

SHARP_GAIN = 40.0
"""of six joints: twice the log evidence, each reading with the misfit it supports, by which another
reading of one joint must be better where the labelled one is not bad; of 140 sound logs it was 30
at most"""
THIN = 3
"""every third row is enough to sort the readings"""
FINALISTS = 4
"""readings that are then compared on all rows"""
STEPS = 3
"""readings on top of each other at most"""
LOST_PRICE = 300.0
"""of six joints: above this, and no reading that fits, the log is not this robot's"""
SINGLE = ("angle_unit", "angle_sign", "axis_sign", "torque_sign", "coupling", "angle_zero")
"""what is asked of each joint alone with a sharper misfit"""
PLACEHOLDERS = 0.5
"""share of the joints whose stated friction is not the arm's, above which none of it is taken for
the arm's"""
SLOWED = 100.0
"""times slower, by which clock only the torques of postures are left of a motion, and"""
POSSIBLE = 1.2
"""of the speed limit at most, for which the clock as labelled is right"""
RESTS = 1e-3
"""[rad] of travel as labelled below which a joint rests, whatever the unit"""
ASKED = 12.0
"""twice the log evidence by which a log as labelled must ask for rotors that no file states"""
BEYOND = 2.0
"""times its range that a joint may go through as it is read"""
OTHER_STRENGTH = (
    "the model explains the torques with another strength of the balancer that the file states "
    "({joints}), not with that one; `irb2400 diagnose` says how much it has lost"
)
DELAYS = (-1.0, -0.5, -0.3, -0.2, -0.1, 0.1, 0.2, 0.3, 0.5, 1.0)
"""[s] shifts of the torques against the motion that are tried"""


@dataclass(frozen=True)
class Understanding:
    """The best reading of a log.

    Args:
        labelled: how well the columns are explained as labelled; best: as `reading` takes them.
        reading: what the columns look like; as labelled where nothing is clearly better.
        other_friction: joints (from 1) on which the log contradicts the friction that the file
            states; it was held against the robot without it.
        although: why it is the arm's as labelled, although the model does not explain it all.
        frictionless: whether the torques hold no friction, as those of a model.
        over_time: the stretch as labelled that does not go with the rest, in words.
    """

    labelled: Fit
    best: Fit
    reading: Reading
    problem: LogProblem | None
    other_friction: tuple[int, ...] = ()
    although: str = ""
    frictionless: bool = False
    over_time: str = ""


def understand(robot: Robot, log: Log) -> Understanding | None:
    """Compare all readings of a log with the robot's nominal model; None where it is too short."""
    rows = rows_of(log)
    if rows is None:
        return None
    nominal = Nominal(robot)
    found = _beside_what_differs(nominal, log, rows)
    return replace(
        found,
        frictionless=hold_no_friction(nominal, rows),
        over_time=disagreement(nominal, rows),
    )


def _beside_what_differs(nominal: Nominal, log: Log, rows: Rows) -> Understanding:
    """The best reading beside rotors, balancers and friction that may not be the file's."""
    robot = nominal.robot
    columns = nominal.columns(rows)
    unstated = nominal.with_unknown_rotors()
    # free where the log as labelled asks for them: with one a spring is a torque turned over
    if unstated.explained(rows, columns).cost < nominal.explained(rows, columns).cost - ASKED:
        nominal = unstated
    found = _understood(nominal, log, rows)
    if nominal.balanced and not sound(found.labelled, robot.n):
        # a gas spring loses its pressure: no column is wrong that fits with another strength
        freed = nominal.with_free_balancers()
        if sound(freed.explained(rows, freed.columns(rows)), robot.n):
            joints = " and ".join(f"joint {j + 1}" for j in nominal.balanced)
            said = OTHER_STRENGTH.format(joints=joints)
            return replace(_understood(freed, log, rows), although=said)
    if found.problem:
        spring = None if nominal.balanced else beside_a_balancer(nominal, rows, found.best)
        if beside := spring or beside_a_coupled_wrist(nominal, rows, found.best):
            fit, said = beside
            return Understanding(fit, fit, as_labelled(robot.n), None, although=said)
    stated = robot.friction.any() and robot.identified is None
    if sound(found.labelled, robot.n) or not stated:
        return found
    # many files state a friction to please a simulator: no column is wrong that fits without it
    every = range(1, robot.n + 1)
    free = _understood(nominal.with_unknown_friction(every), log, rows)
    if found.best.cost - free.best.cost < MARGIN * robot.n / 6.0:
        return found
    off = _contradicted(nominal, log, rows, free)
    return replace(free, other_friction=off) if off else found


def _contradicted(nominal: Nominal, log: Log, rows: Rows, free: Understanding) -> tuple[int, ...]:
    """Joints (from 1) whose stated friction explains a log worse than an unknown one; all, where
    most do.
    """
    every = set(range(1, nominal.robot.n + 1))
    off = []
    for j in sorted(every):
        stated = _Search(nominal.with_unknown_friction(every - {j}), log, rows)
        if stated.fit(free.reading).cost > free.best.cost:
            off.append(j)
    # where most of them say nothing of the arm, the file's friction is a placeholder
    return tuple(sorted(every) if len(off) > PLACEHOLDERS * len(every) else off)


def _understood(nominal: Nominal, log: Log, rows: Rows) -> Understanding:
    """The best reading of a log beside a robot's model."""
    robot = nominal.robot
    search = _Search(nominal, log, rows)
    plain = as_labelled(robot.n)
    labelled = search.fit(plain)
    reading = plain
    best = labelled
    columns = search.columns_of(plain, rows)
    alone = only_one_off(nominal, rows, columns, labelled)
    scale = robot.n / 6.0
    for _ in range(STEPS):
        if sound(best, robot.n):
            break
        found = search.better(reading, best)
        if found is None:
            break
        reading, best = found
    if reading is plain:
        reading, best = search.misread(plain, best) or (plain, best)
    otherwise = reading is not plain
    problem: LogProblem | None = None
    although = "" if alone is None else own(labelled, alone)
    if alone and reading.joints != (alone,) and not sound(best, robot.n):
        reading = plain
        best = labelled
    elif otherwise and best.price < FITS_PRICE * scale:
        problem = strange(reading, best) or with_its_rival(reading, best, search.fit)
    elif labelled.price > LOST_PRICE * scale and not alone:
        if pushed(nominal, rows, columns):
            although = PUSHED
            reading = plain
            best = labelled
        else:
            near = otherwise and best.price < LOST_PRICE * scale
            problem = nearly(labelled, reading, best) if near else lost(labelled)
    if not sound(labelled, robot.n):
        part, said = best_part(nominal, rows, labelled)
        better = best.cost - part.cost > MARGIN or _slowed(robot, log, reading)
        # what holds a joint at rest may be friction, of which no part can be told
        moves = np.ptp(rows.q, axis=0) > MOVES
        clear = clearly_better(part, labelled, on=moves)
        fits = sound(part, robot.n) if alone else part.price < FITS_PRICE * scale
        least = min(best.cost, part.cost)
        if better and clear and fits:
            problem = said
            best = part
        if not alone:
            problem = mounting_problem(nominal, rows, labelled, least, problem) or problem
    return Understanding(labelled, best, reading, problem, although=although)


def _slowed(robot: Robot, log: Log, reading: Reading) -> bool:
    """Whether a reading slows down a motion that the robot can make as it is labelled."""
    speed = fastest(robot, log)
    return reading.clock >= SLOWED and bool(speed.any()) and bool(speed.max() < POSSIBLE)


class _Search:
    """Readings of one log, tried on top of each other."""

    def __init__(self, nominal: Nominal, log: Log, rows: Rows, keep: int = 1) -> None:
        self._nominal = nominal
        self._log = log
        self._keep = keep
        self._rows = {0.0: rows.thinned(keep)}
        self._columns: dict[bytes, tuple[Array, Array]] = {}

    def rows(self, reading: Reading) -> Rows | None:
        """The log as a reading takes it."""
        delay = reading.delay
        if delay not in self._rows:
            found = rows_of(self._log, delay)
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
        quick = _Search(self._nominal, self._log, self._rows[0.0], THIN)
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
        quick = _Search(self._nominal, self._log, self._rows[0.0], THIN)
        every = [*motion_readings(robot), *torque_readings(robot)]
        single = [r for r in every if len(r.joints) == 1 and r.kind in SINGLE and self._shows(r)]
        costs = [quick.sharp_cost(reading, (MISFITS[-2],)) for reading in single]
        best = single[int(np.argmin(costs))]
        gain = self.sharp_cost(plain) - self.sharp_cost(best)
        if gain < SHARP_GAIN * robot.n / 6.0:
            return None
        found = self.fit(best)
        return None if at_others_cost(best, found, labelled) else (best, found)

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
        read = np.ptp(self._log.q @ reading.angles.T, axis=0)
        if ((read > BEYOND * room) & (travel <= room)).any():
            return False
        if len(reading.joints) != 1:
            return True
        return bool(travel[reading.joints[0] - 1] > RESTS)

    @cached_property
    def _travel(self) -> Array:
        """Of each joint as labelled, shape (n,) [rad]."""
        return np.asarray(np.ptp(self._log.q, axis=0))

    def columns_of(self, reading: Reading, rows: Rows) -> tuple[Array, Array]:
        """As of `Nominal.columns`; what was asked last is kept."""
        key = reading.angles.tobytes() + reading.offset.tobytes()
        key += np.array([reading.clock, reading.delay]).tobytes()
        if key not in self._columns:
            if len(self._columns) > 8:
                self._columns.clear()
            self._columns[key] = self._nominal.columns(rows)
        return self._columns[key]
