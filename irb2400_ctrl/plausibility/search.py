"""Which reading of a log's columns a robot's model explains, before any effect is tried."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility.balancer import beside_a_balancer
from irb2400_ctrl.plausibility.columns.jumps import MOVES
from irb2400_ctrl.plausibility.coupled_wrist import beside_a_coupled_wrist
from irb2400_ctrl.plausibility.criteria import (
    FITS_PRICE,
    MARGIN,
    PUSHED,
    clearly_better,
    gains_clearly,
    lost,
    nearly,
    only_one_off,
    own,
    sound,
    strange,
)
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.mounting import mounting_problem
from irb2400_ctrl.plausibility.over_time import disagreement
from irb2400_ctrl.plausibility.parts import best_part, hold_no_friction
from irb2400_ctrl.plausibility.problem import LogProblem
from irb2400_ctrl.plausibility.pushed import pushed
from irb2400_ctrl.plausibility.reading import Reading, as_labelled
from irb2400_ctrl.plausibility.rival_signs import with_its_rival
from irb2400_ctrl.plausibility.rows import Rows, rows_of
from irb2400_ctrl.plausibility.travel import fastest
from irb2400_ctrl.plausibility.tried_readings import TriedReadings
from irb2400_ctrl.robot import Robot

STEPS = 3
"""readings on top of each other at most"""
LOST_PRICE = 300.0
"""of six joints: above this, and no reading that fits, the log is not this robot's"""
PLACEHOLDERS = 0.5
"""share of the joints whose stated friction is not the arm's, above which none of it is taken for
the arm's"""
SLOWED = 100.0
"""times slower, by which clock only the torques of postures are left of a motion, and"""
POSSIBLE = 1.2
"""of the speed limit at most, for which the clock as labelled is right"""
ASKED = 12.0
"""twice the log evidence by which a log as labelled must ask for rotors that no file states"""
OTHER_STRENGTH = (
    "the model explains the torques with another strength of the balancer that the file states "
    "({joints}), not with that one; `irb2400 diagnose` says how much it has lost"
)


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
        fit = freed.explained(rows, freed.columns(rows))
        if gains_clearly(fit, found.labelled) and sound(fit, robot.n):
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
    if not gains_clearly(free.best, found.best):
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
        stated = TriedReadings(nominal.with_unknown_friction(every - {j}), log, rows)
        if stated.fit(free.reading).cost > free.best.cost:
            off.append(j)
    # where most of them say nothing of the arm, the file's friction is a placeholder
    return tuple(sorted(every) if len(off) > PLACEHOLDERS * len(every) else off)


def _understood(nominal: Nominal, log: Log, rows: Rows) -> Understanding:
    """The best reading of a log beside a robot's model."""
    robot = nominal.robot
    search = TriedReadings(nominal, log, rows)
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
