"""The instants at which a log was sampled, from stamps that a host wrote when it came to it.

A controller samples evenly; the stamps of a host scatter by a millisecond, and samples get lost.
A stamp off by dt is an angle off by qd dt, and its second difference, times the mass matrix, is a
torque. The even instants t0 + k h are found from the stamps, and the angles are asked which of the
two they were sampled at.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.instants.even_instants import (
    BLURRED,
    closed,
    dense,
    lattice_near,
    lattices,
    losses_placed,
    missed_by,
    rougher,
    roughness,
)
from irb2400_ctrl.measurement.instants.grouped_stamps import grouped
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.motion.held_samples import released

LEAST = 20
"""samples below which nothing is rebuilt"""
EVEN = 2e-6
"""[s] scatter of the stamps below which they need no help"""
FINER = 6
"""lattices up to so many times finer than the median step are tried"""
SINGLE = 0.1
"""share of the steps that are one period of a finer lattice: where samples of an even clock are
lost some neighbours stay; instants that are uneven themselves are near to any fine lattice"""
ALIKE = 1.05
"""times the least roughness: lattices on which the angles are as smooth"""
SMOOTHER = 0.98
"""an even time base must leave less roughness than this share of what the stamps leave"""
DECIDED = 0.05
"""how near to 0 the slope must be, besides two standard errors: the sampling was even"""
MOTION = 0.02
"""share of a joint's travel that interpolation may miss of what are samples of one motion"""
DIGIT = 1e-3
"""[rad] that the digits of its angle may add to that"""
OFF = 0.1
"""periods that the instants of samples of one motion are off at most, median"""
NEXT_GROUP = 0.98
"""quantile of the steps that is one from a group to the next"""
SURE = 0.1
"""standard error of the slope at most"""


@dataclass(frozen=True)
class TimeBase:
    """What the stamps and the angles say about the instants of the samples.

    Args:
        time: the instants to use [s], shape (m,).
        period: of the even sampling [s].
        scatter: rms of the stamps about the even instants [s].
        lost: share of the even instants without a sample.
        slope: 0 when the sampling was even and the stamps scatter, 1 when the stamps are right.
        rebuilt: whether `time` are the even instants instead of the stamps.
    """

    time: Array
    period: float
    scatter: float
    lost: float
    slope: float = 0.0
    rebuilt: bool = False


def time_base(log: Log) -> TimeBase:
    """The instants of a log's samples: even ones where the angles agree, else the stamps."""
    stamps = log.time
    by_number = counted(log)
    if by_number is not None:
        return by_number
    # any fine lattice follows groups of which samples were lost
    if len(stamps) < LEAST or grouped(stamps, clearly=True):
        return TimeBase(stamps, float(np.median(np.diff(stamps))), 0.0, 0.0)
    best: tuple[float, Array, float] | None = None
    exact: TimeBase | None = None
    rough_stamps = roughness(log.q, stamps)
    for finer in range(1, FINER + 1):
        found = lattices(stamps, finer)
        instants, step = found[0]
        near = float(np.std(stamps - instants))
        if near < EVEN:
            exact = TimeBase(stamps, step, near, _lost(instants, step))
            if finer == 1:
                return exact
            # the digits of a clock are such a lattice, too: the angles know
            break
        ratios = [rougher(roughness(log.q, one), rough_stamps) for one, _ in found]
        # stamps that scatter by more than a quarter of a period are near to wrong lattices as
        # well: the angles know
        rough = min(ratios)
        smooth = [one for one, ratio in zip(found, ratios, strict=True) if ratio < ALIKE * rough]
        instants, step = min(smooth, key=lambda one: float(np.std(stamps - one[0])))
        if finer > 1 and np.mean(np.diff(instants) < 1.5 * step) < SINGLE:
            continue
        # a finer lattice follows any stamps a little better: it must be worth it
        if best is None or rough < 0.8 * best[0]:
            best = rough, instants, step
    assert best is not None
    rough, even, step = best
    if np.std(stamps - even) > BLURRED * step:
        even = losses_placed(log.q, even, step)
        rough = rougher(roughness(log.q, even), rough_stamps)
    scatter = float(np.std(stamps - even))
    slope, error = _slope(log, even)
    told = error < SURE and abs(slope) < DECIDED + 2.0 * error
    rebuilt = scatter > EVEN and told and rough < SMOOTHER
    if exact is not None and not rebuilt:
        return exact
    time = even if rebuilt else stamps
    return TimeBase(time, step, scatter, _lost(even, step), slope, rebuilt)


def counted(log: Log) -> TimeBase | None:
    """Even instants of samples that a host got in groups, by their number; None where the stamps or
    the angles do not say so."""
    if not grouped(log.time):
        return None
    even, step = lattice_near(log.time, float(np.mean(np.diff(log.time))))
    # pauses of the lattice are those of groups as well, and a period that is a little off
    even = closed(log.q, losses_placed(log.q, even, step), step)
    places = np.round((even - even[0]) / step)
    step, start = np.polyfit(places, log.time, 1)
    even = np.asarray(start + step * places)
    slope, error = _slope(log, even)
    told = error < SURE and abs(slope) < DECIDED + 2.0 * error
    # where the stamps are near enough to interpolate from, too
    rough = rougher(roughness(log.q, even), roughness(log.q, log.time, even))
    if not told or rough >= SMOOTHER or not _of_one_motion(log.q, even):
        return None
    scatter = float(np.std(log.time - even))
    # a sample waits for its group and no longer: a clock of another period drifts away
    if scatter > np.quantile(np.diff(log.time), NEXT_GROUP):
        return None
    return TimeBase(even, float(step), scatter, _lost(even, step), slope, rebuilt=True)


def _lost(even: Array, step: float) -> float:
    """Share of the even instants without a sample."""
    return 1.0 - len(even) / (round(float(even[-1] - even[0]) / step) + 1)


def vouched_for(log: Log) -> bool:
    """Whether the angles bear out an even time base, as samples of one motion."""
    base = time_base(log)
    return base.rebuilt and _of_one_motion(log.q, base.time)


def _of_one_motion(q: Array, time: Array) -> bool:
    """Whether interpolation misses little of the motion, and no more where it is fast: noise does
    not know the speed, an instant that is off does."""
    if (roughness(q, time) > MOTION * np.ptp(q, axis=0) + DIGIT).any():
        return False
    inside = dense(time)
    missed = np.abs(missed_by(q, time)[inside])
    steps = np.abs(np.gradient(q, axis=0)[2:-2][inside])
    off = []
    for one, step in zip(missed.T, steps.T, strict=True):
        slow = step <= np.quantile(step, 0.3)
        fast = step >= np.quantile(step, 0.7)
        if np.median(step[fast]) > 0.0:
            beyond = float(np.median(one[fast]) - np.median(one[slow]))
            off.append(beyond / float(np.median(step[fast])))
    return not off or float(np.median(off)) < OFF


def ungrouped(log: Log) -> Log:
    """All rows of a log on even instants where its stamps are those of groups of samples."""
    base = counted(log)
    return log if base is None else replace(log, time=base.time)


def with_time_base(log: Log) -> Log:
    """The rows of a log that are new (`held_samples`) on their rebuilt time base; the log itself
    where all are, and its stamps are as good."""
    log = released(log)[0]
    base = time_base(log)
    return replace(log, time=base.time) if base.rebuilt else log


def _slope(log: Log, even: Array) -> tuple[float, float]:
    """Regression of what interpolation on the even instants misses on speed times scatter."""
    scatter = (log.time - even)[:, None]
    speed = np.gradient(log.q, even, axis=0)[2:-2]
    inside = dense(even)
    x = (speed * missed_by(scatter, even))[inside]
    y = missed_by(log.q, even)[inside]
    size = np.std(y, axis=0) + 1e-12
    x = (x / size).ravel()
    y = (y / size).ravel()
    power = float(x @ x)
    if len(x) < 20 or power < 1.0:
        return 0.0, np.inf
    slope = float(x @ y) / power
    error = float(np.sqrt(np.mean((y - slope * x) ** 2) / power))
    return slope, error
