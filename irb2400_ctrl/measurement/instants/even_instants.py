"""Even instants that the stamps of samples may stand for, and how smooth the angles are on them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.fft import next_fast_len, rfft
from scipy.optimize import isotonic_regression

from irb2400_ctrl.arrays import Array, Mask

Index = npt.NDArray[np.int64]

LONGEST = 60.0
"""[s] of the record that the search for the period looks at"""
MOST_PERIODS = 100_000
"""that the search looks at: bounds its memory whatever the stamps are"""
BINS = 8
"""per period, in that search"""
WIDTH = 0.1
"""relative half width of the search about the median step"""
BLURRED = 0.25
"""scatter of the stamps over the period above which their phase may be lost: one spread evenly
over a whole period has none"""
NEARBY = ((4.0, 0.04), (LONGEST, 0.002))
"""[s] of the record, relative half width of the search for a period whose lattice the stamps are
nearer to: first coarse, then fine"""
TRIED = 81
"""periods in each"""
WORTH = 1.2
"""times what the angles miss without a pause must be at least of what they miss with it"""
MISPLACED = 6
"""samples by which the place of a loss may be off"""


def lattices(stamps: Array, finer: int) -> list[tuple[Array, float]]:
    """Even instants that the stamps may stand for, with their periods."""
    first = lattice_near(stamps, _period(stamps, finer))
    if finer > 1 or np.std(stamps - first[0]) <= BLURRED * first[1]:
        return [first]
    median = float(np.median(np.diff(stamps)))
    finely = _nearest_lattice(stamps, first[1], NEARBY[1:])
    return [first, finely, _nearest_lattice(stamps, median, NEARBY)]


def lattice_near(stamps: Array, period: float) -> tuple[Array, float]:
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
    return lattice_near(stamps, period)


def closed(q: Array, even: Array, step: float) -> Array:
    """The instants without the pauses that do not make the angles smoother: samples that came late
    look like samples that were lost.

    Args:
        q: angles, shape (m, n); even: instants [s], shape (m,); step: their period [s].
    """
    even = even.copy()
    for after in (np.flatnonzero(np.diff(even) > 1.5 * step) + 1).tolist():
        pause = even[after] - even[after - 1] - step
        first = max(after - MISPLACED, 0)
        window = slice(first, after + MISPLACED)
        if after >= MISPLACED and after + MISPLACED <= len(even):
            tried = even[window].copy()
            tried[after - first :] -= pause
            size = np.median(np.abs(missed_by(q[window], tried)), axis=0) + 1e-12
            without, beside = (
                float(np.sum(np.abs(missed_by(q[window], time)) / size))
                for time in (tried, even[window])
            )
            if without >= WORTH * beside:
                continue
        even[after:] -= pause
    return even


def losses_placed(q: Array, even: Array, step: float) -> Array:
    """The instants with every loss moved to where the angles are smooth.

    Stamps that scatter by a good part of a period do not tell between which samples one was lost,
    and a few samples a period off are a jump of the angles.

    Args:
        q: angles, shape (m, n); even: instants [s], shape (m,); step: their period [s].
    """
    even = even.copy()
    for after in (np.flatnonzero(np.diff(even) > 1.5 * step) + 1).tolist():
        first = max(after - MISPLACED - 4, 0)
        window = slice(first, after + MISPLACED + 4)
        if after - first < 5 or after + MISPLACED + 4 > len(even):
            continue
        size = np.median(np.abs(missed_by(q[window], even[window])), axis=0) + 1e-12
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
            missed = float(np.sum(np.abs(missed_by(q[window], tried)) / size))
            if missed < least:
                least = missed
                best = tried
        even[window] = best
    return even


def _rising(places: Array) -> Index:
    """Whole numbers next to the places, each above the one before."""
    count = np.arange(len(places))
    return np.asarray(np.round(isotonic_regression(places - count).x), dtype=np.int64) + count


def missed_by(q: Array, time: Array) -> Array:
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


def dense(time: Array) -> Mask:
    """Where the neighbours are near enough to interpolate from."""
    return np.asarray((time[4:] - time[:-4]) < 8.0 * np.median(np.diff(time)))


def roughness(q: Array, time: Array, near: Array | None = None) -> Array:
    """Robust size of what interpolation misses, per joint [rad].

    Args:
        q: angles, shape (m, n); time: instants [s], shape (m,).
        near: instants that are near enough to interpolate from where it is asked; default `time`.
    """
    where = dense(time if near is None else near)
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.abs(missed_by(q, time)[where])
    if not len(size):
        return np.ones(q.shape[1])
    # the median alone would not see a few wrong steps
    return np.asarray(np.quantile(size, 0.5, axis=0) + np.quantile(size, 0.9, axis=0) + 1e-12)


def rougher(one: Array, other: Array) -> float:
    logarithms: Array = np.log(one / other)
    return float(np.exp(logarithms.mean()))
