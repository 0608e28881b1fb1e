"""The instants at which a log was sampled, from stamps that a host wrote when it came to it.

A controller samples evenly; the stamps of a host scatter by a millisecond, and samples get lost.
A stamp off by dt is an angle off by qd dt, and its second difference, times the mass matrix, is a
torque. The even instants t0 + k h are found from the stamps, and the angles are asked which of the
two they were sampled at.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.fft import next_fast_len, rfft
from scipy.optimize import isotonic_regression

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.motion.held_samples import released

Index = npt.NDArray[np.int64]

LEAST = 20
"""samples below which nothing is rebuilt"""
EVEN = 2e-6
"""[s] scatter of the stamps below which they need no help"""
LONGEST = 60.0
"""[s] of the record that the search for the period looks at"""
MOST_PERIODS = 100_000
"""that the search looks at: bounds its memory whatever the stamps are"""
BINS = 8
"""per period, in that search"""
WIDTH = 0.1
"""relative half width of the search about the median step"""
FINER = 6
"""lattices up to so many times finer than the median step are tried"""
SINGLE = 0.1
"""share of the steps that are one period of a finer lattice: where samples of an even clock are
lost some neighbours stay; instants that are uneven themselves are near to any fine lattice"""
BLURRED = 0.25
"""scatter of the stamps over the period above which their phase may be lost: one spread evenly
over a whole period has none"""
NEARBY = ((4.0, 0.04), (LONGEST, 0.002))
"""[s] of the record, relative half width of the search for a period whose lattice the stamps are
nearer to: first coarse, then fine"""
TRIED = 81
"""periods in each"""
MISPLACED = 6
"""samples by which the place of a loss may be off"""
ALIKE = 1.05
"""times the least roughness: lattices on which the angles are as smooth"""
SMOOTHER = 0.98
"""an even time base must leave less roughness than this share of what the stamps leave"""
DECIDED = 0.05
"""how near to 0 the slope must be, besides two standard errors: the sampling was even"""
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
    if len(stamps) < LEAST:
        return TimeBase(stamps, float(np.median(np.diff(stamps))), 0.0, 0.0)
    best: tuple[float, Array, float] | None = None
    exact: TimeBase | None = None
    rough_stamps = _roughness(log.q, stamps)
    for finer in range(1, FINER + 1):
        lattices = _lattices(stamps, finer)
        instants, step = lattices[0]
        near = float(np.std(stamps - instants))
        if near < EVEN:
            exact = TimeBase(stamps, step, near, _lost(instants, step))
            if finer == 1:
                return exact
            # the digits of a clock are such a lattice, too: the angles know
            break
        ratios = [_ratio(_roughness(log.q, one), rough_stamps) for one, _ in lattices]
        # stamps that scatter by more than a quarter of a period are near to wrong lattices as
        # well: the angles know
        rough = min(ratios)
        smooth = [one for one, ratio in zip(lattices, ratios, strict=True) if ratio < ALIKE * rough]
        instants, step = min(smooth, key=lambda one: float(np.std(stamps - one[0])))
        if finer > 1 and np.mean(np.diff(instants) < 1.5 * step) < SINGLE:
            continue
        # a finer lattice follows any stamps a little better: it must be worth it
        if best is None or rough < 0.8 * best[0]:
            best = rough, instants, step
    assert best is not None
    rough, even, step = best
    if np.std(stamps - even) > BLURRED * step:
        even = _losses_placed(log.q, even, step)
        rough = _ratio(_roughness(log.q, even), rough_stamps)
    scatter = float(np.std(stamps - even))
    slope, error = _slope(log, even)
    told = error < SURE and abs(slope) < DECIDED + 2.0 * error
    rebuilt = scatter > EVEN and told and rough < SMOOTHER
    if exact is not None and not rebuilt:
        return exact
    time = even if rebuilt else stamps
    return TimeBase(time, step, scatter, _lost(even, step), slope, rebuilt)


def _lost(even: Array, step: float) -> float:
    """Share of the even instants without a sample."""
    return 1.0 - len(even) / (round(float(even[-1] - even[0]) / step) + 1)


def with_time_base(log: Log) -> Log:
    """The rows of a log that are new (`held_samples`) on their rebuilt time base; the log itself
    where all are, and its stamps are as good."""
    log = released(log)[0]
    base = time_base(log)
    return replace(log, time=base.time) if base.rebuilt else log


def _period(stamps: Array, finer: int) -> float:
    """Period near the median step over `finer` that the stamps keep in phase best:
    max |sum exp(2 pi i f t)|, the sum by one Fourier transform."""
    near = float(np.median(np.diff(stamps))) / finer
    span = min(LONGEST, MOST_PERIODS * near)
    t = stamps[stamps < stamps[0] + span] - stamps[0]
    bin_width = near / BINS
    length = int(next_fast_len(4 * int(np.ceil(t[-1] / bin_width) + 1), real=True))
    counts = np.bincount(np.round(t / bin_width).astype(np.int64), minlength=length)
    frequencies = np.fft.rfftfreq(length, bin_width)
    inside = np.flatnonzero(np.abs(frequencies * near - 1.0) < WIDTH)
    if not len(inside):
        return near
    size = np.abs(rfft(counts.astype(float)))[inside]
    place = inside[int(np.argmax(size))]
    return 1.0 / float(frequencies[place])


def _lattice(stamps: Array, period: float) -> tuple[Array, float]:
    """Even instants of the samples and their period, by least squares on rising whole numbers."""
    origin = float(stamps[0])
    for _ in range(5):
        index = _rising((stamps - origin) / period)
        slope, start = np.polyfit(index - index.mean(), stamps, 1)
        origin = float(start - slope * index.mean())
        if abs(slope / period - 1.0) < 1e-12:
            break
        period = float(slope)
    return np.asarray(origin + period * index, dtype=float), period


def _lattices(stamps: Array, finer: int) -> list[tuple[Array, float]]:
    """Even instants that the stamps may stand for, with their periods."""
    first = _lattice(stamps, _period(stamps, finer))
    if finer > 1 or np.std(stamps - first[0]) <= BLURRED * first[1]:
        return [first]
    median = float(np.median(np.diff(stamps)))
    finely = _nearest_lattice(stamps, first[1], NEARBY[1:])
    return [first, finely, _nearest_lattice(stamps, median, NEARBY)]


def _nearest_lattice(
    stamps: Array, period: float, searches: Sequence[tuple[float, float]]
) -> tuple[Array, float]:
    """The lattice near a period that leaves the least scatter; `searches` as NEARBY.

    Samples that are lost look like a longer period; with the right one the stamps step by whole
    periods instead of drifting.
    """
    for span, width in searches:
        first = stamps[stamps < stamps[0] + span] - stamps[0]
        tried = period * (1.0 + np.linspace(-width, width, TRIED))
        scatter = [np.std(first - one * _rising(first / one)) for one in tried]
        period = float(tried[int(np.argmin(scatter))])
    return _lattice(stamps, period)


def _losses_placed(q: Array, even: Array, step: float) -> Array:
    """The instants with every loss moved to where the angles are smooth.

    Stamps that scatter by a good part of a period do not tell between which samples one was lost,
    and a few samples a period off are a jump of the angles.
    """
    even = even.copy()
    for after in (np.flatnonzero(np.diff(even) > 1.5 * step) + 1).tolist():
        first = max(after - MISPLACED - 4, 0)
        window = slice(first, after + MISPLACED + 4)
        if after - first < 5 or after + MISPLACED + 4 > len(even):
            continue
        size = np.median(np.abs(_missed(q[window], even[window])), axis=0) + 1e-12
        pause = even[after] - even[after - 1] - step
        best = even[window]
        least = np.inf
        for shift in range(-MISPLACED, MISPLACED + 1):
            tried = even[window].copy()
            inner = after - first
            if shift > 0:
                tried[inner : inner + shift] -= pause
            else:
                tried[inner + shift : inner] += pause
            if (np.diff(tried) < 0.5 * step).any():
                continue
            missed = float(np.sum(np.abs(_missed(q[window], tried)) / size))
            if missed < least:
                least = missed
                best = tried
        even[window] = best
    return even


def _rising(places: Array) -> Index:
    """Whole numbers next to the places, each above the one before."""
    count = np.arange(len(places))
    return np.asarray(np.round(isotonic_regression(places - count).x), dtype=np.int64) + count


def _missed(q: Array, time: Array) -> Array:
    """What cubic interpolation from two neighbours on each side misses, shape (m - 4, n)."""
    t = [time[k : len(time) - 4 + k] for k in (0, 1, 3, 4)]
    here = time[2:-2]
    missed = q[2:-2].copy()
    for place, k in enumerate((0, 1, 3, 4)):
        weight = np.ones(len(here))
        for other in range(4):
            if other != place:
                weight *= (here - t[other]) / (t[place] - t[other])
        missed -= weight[:, None] * q[k : len(q) - 4 + k]
    return missed


def _dense(time: Array) -> Mask:
    """Where the neighbours are near enough to interpolate from."""
    return np.asarray((time[4:] - time[:-4]) < 8.0 * np.median(np.diff(time)))


def _roughness(q: Array, time: Array) -> Array:
    """Robust size of what interpolation misses, per joint [rad]."""
    missed = np.abs(_missed(q, time)[_dense(time)])
    if not len(missed):
        return np.ones(q.shape[1])
    # the median alone would not see a few wrong steps
    return np.asarray(np.quantile(missed, 0.5, axis=0) + np.quantile(missed, 0.9, axis=0) + 1e-12)


def _ratio(one: Array, other: Array) -> float:
    logarithms: Array = np.log(one / other)
    return float(np.exp(logarithms.mean()))


def _slope(log: Log, even: Array) -> tuple[float, float]:
    """Regression of what interpolation on the even instants misses on speed times scatter."""
    scatter = (log.time - even)[:, None]
    speed = np.gradient(log.q, even, axis=0)[2:-2]
    inside = _dense(even)
    x = (speed * _missed(scatter, even))[inside]
    y = _missed(log.q, even)[inside]
    size = np.std(y, axis=0) + 1e-12
    x = (x / size).ravel()
    y = (y / size).ravel()
    power = float(x @ x)
    if len(x) < 20 or power < 1.0:
        return 0.0, np.inf
    slope = float(x @ y) / power
    error = float(np.sqrt(np.mean((y - slope * x) ** 2) / power))
    return slope, error
