"""What a model leaves of a log that is quicker than laws are compared on: vibrations, and moments
at which several joints are far off at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.measurement.uniform import widened
from irb2400_ctrl.wording import numbered

FASTEST = 9.0
"""[Hz] up to which vibrations are among the laws"""
OF_RATE = 0.45
"""of the sampling rate, up to which a spectrum says something"""
BAND = 0.5
"""[Hz] on both sides of a vibration that does not turn quite evenly"""
AROUND = 4.0
"""[Hz] on both sides, where the spectrum tells what is there without it"""
STANDS_OUT = 60.0
"""times the spectrum around it that a vibration's peak is at least; `benchmarks/quick_rests.py`
counts arms that have one and arms that have none"""
LOUD = 0.35
"""of the noise that a vibration has at least [rms over rms]"""
FAR = 5.0
"""times the noise from which a joint is far off"""
BESIDE = 0.05
"""[s] before and after that belong to a moment"""
TURNS = 0.1
"""[s] before and after a joint turns, when it shakes the others: no moment begins there"""
SLIDES = 0.02
"""[rad] from a turn to where a contact slides; no moment begins on the way there"""
STARTS = 0.5
"""[s] that way takes at most; what is slower rests"""
BEGINNING = 0.5
"""[s] of a log in which contacts and control settle: no moment begins there either"""
SETS_IN = 0.5
"""[s] before and after a force acts, in which it sets in or fades away"""
MUCH = 0.45
"""of the noise that moments leave of the samples apart from turns, at least [rms over rms]"""
REST = 2.0
"""times the noise that is left of the other samples, above which nothing is said of moments; times
as many as they the other samples are at least"""
LITTLE = 0.003
"""of a joint's rms torque, below which neither matters"""
SHOWN = 5
"""moments that are told one by one"""


@dataclass(frozen=True)
class Vibration:
    """On one joint (from 1): frequency [Hz], rms [Nm]."""

    joint: int
    frequency: float
    rms: float


@dataclass(frozen=True)
class Moments:
    """When several joints were far off at once.

    Args:
        joints: of which they leave much; starts: of each [s].
        share: of the samples; largest: what is left on the joint that shows them most [Nm].
    """

    joints: tuple[int, ...]
    starts: tuple[float, ...]
    share: float
    largest: float


@dataclass(frozen=True)
class QuickRests:
    """Of all logs; empty where there is nothing of the kind."""

    vibrations: tuple[Vibration, ...] = ()
    moments: Moments | None = None

    @property
    def joints(self) -> tuple[int, ...]:
        """From 1."""
        moments = () if self.moments is None else self.moments.joints
        return tuple(sorted({*(one.joint for one in self.vibrations), *moments}))

    @property
    def sentences(self) -> tuple[str, ...]:
        """For notes."""
        found = []
        rest = list(self.vibrations)
        while rest:
            first = rest[0]
            same = [one for one in rest if abs(one.frequency - first.frequency) < BAND]
            rest = [one for one in rest if one not in same]
            most = max(same, key=lambda one: one.rms)
            found.append(
                f"a vibration of {first.frequency:.1f} Hz is left on "
                f"{numbered('joint', [one.joint for one in same])}, {most.rms:.2g} Nm rms on joint "
                f"{most.joint}: no effect is looked for above {FASTEST:.0f} Hz; a spindle, a fan "
                "or a loop that swings has such a one"
            )
        if self.moments is not None:
            found.append(_sentence(self.moments))
        return tuple(found)


def _sentence(moments: Moments) -> str:
    starts = ", ".join(f"{start:.1f}" for start in moments.starts[:SHOWN])
    count = len(moments.starts)
    more = ", …" if count > SHOWN else ""
    when = f"at {count} moments" if count > 1 else "at one moment"
    return (
        f"{when} ({starts}{more} s), {100.0 * moments.share:.1f} % of the log, several joints are "
        f"far off at once, by up to {moments.largest:.2g} Nm on joint {moments.joints[0]}, where "
        "the rest of the log is noise: knocks, readings that stood still, or what shows seldom"
    )


def quick_rests(
    motion: PreparedLog, predicted: Array, floor: Array, effects: Sequence[Effect]
) -> QuickRests:
    """Whatever there is of them.

    Args:
        motion: with the torque that was measured; predicted: along it, shape (m, n) [Nm];
        floor: rms of the noise, shape (n,) [Nm]; effects: that were found.
    """
    left = np.where(motion.known, motion.tau - predicted, 0.0)
    # a prediction along smoothed angles lacks every bend of the torque: so does the smoothed one
    alike = np.where(motion.known, motion.tau_smooth - predicted, 0.0)
    enough = LITTLE * rms(motion.tau)
    vibrations = [
        found
        for j in range(motion.n)
        if (found := _vibration(j, motion, left[:, j], max(LOUD * floor[j], enough[j])))
    ]
    least = np.maximum(MUCH * floor, enough)
    return QuickRests(tuple(vibrations), _moments(motion, alike, floor, least, effects))


def _around_turns(motion: PreparedLog) -> Mask:
    """Samples, shape (m,), around which a joint turns, starts or stops: it shakes the others, and
    until it slides its friction is not what it is afterwards."""
    rows = np.arange(len(motion.time))[:, None]
    turns = np.zeros(motion.qd.shape, dtype=bool)
    turns[1:] = np.diff(np.sign(motion.qd), axis=0) != 0.0
    last = np.maximum.accumulate(np.where(turns, rows, 0), axis=0)
    travelled = np.abs(motion.q - np.take_along_axis(motion.q, last, axis=0))
    starting = (travelled < SLIDES) & ((rows - last) * motion.step < STARTS)
    shaken = widened(np.any(turns, axis=1), round(TURNS / motion.step))
    return np.asarray(shaken | np.any(starting, axis=1))


def _roughly_known(motion: PreparedLog, effects: Sequence[Effect]) -> Mask:
    """Samples, shape (m,), at which a transmission swings, or a force acts or sets in: nobody knows
    so well how."""
    rough = np.zeros(len(motion.time), dtype=bool)
    for effect in effects:
        if effect.search.device:
            rough[:] = True
        if effect.search.comes_and_goes:
            rough |= widened(effect.active(motion.time), round(SETS_IN / motion.step))
    return rough


def _vibration(j: int, motion: PreparedLog, left: Array, least: float) -> Vibration | None:
    """The strongest line above `FASTEST` on a joint (from 0), on the part of the record that shows
    it most; None for none of at least that rms [Nm]."""
    found = [_line(left[part], motion.known[part, j], motion.step) for part in motion.parts]
    frequency, size = max(found, key=lambda one: one[1])
    return Vibration(j + 1, frequency, size) if size > least else None


def _line(left: Array, known: Mask, step: float) -> tuple[float, float]:
    """Frequency [Hz] and rms [Nm] of a line that stands out of the spectrum, both zero for none."""
    from scipy.signal import periodogram

    none = (0.0, 0.0)
    frequency, density = periodogram(left, 1.0 / step, window="hann")
    counts = (frequency > FASTEST) & (frequency < OF_RATE / step)
    frequency = frequency[counts]
    density = density[counts]
    if not len(density):
        return none
    peak = int(np.argmax(density))
    apart = np.abs(frequency - frequency[peak])
    band = apart < BAND
    around = density[(apart < AROUND) & ~band]
    if not len(around) or density[peak] < STANDS_OUT * np.median(around):
        return none
    # the mean of a spectrum's density, of which the median is log 2
    power = np.sum(density[band] - np.median(around) / np.log(2.0)) * (frequency[1] - frequency[0])
    return float(frequency[peak]), float(np.sqrt(max(power, 0.0) / max(known.mean(), 1e-3)))


def _moments(
    motion: PreparedLog, left: Array, floor: Array, least: Array, effects: Sequence[Effect]
) -> Moments | None:
    """Moments apart from turns at which what is left of several joints is far beyond noise; None
    where no joint has so much of them, shape (n,) [Nm rms], beside noise."""
    floor = np.maximum(floor, 1e-12)
    apart = ~_around_turns(motion) & ~_roughly_known(motion, effects)
    for part in motion.parts:
        apart[part.start : part.start + round(BEGINNING / motion.step)] = False
    several = apart & (np.sum(np.abs(left) > FAR * floor, axis=1) > 1)
    near = widened(several, round(BESIDE / motion.step))
    first = np.flatnonzero(np.diff(near.astype(int), prepend=0) == 1)
    near &= apart
    counts = np.maximum(motion.known[apart].sum(axis=0), 1)
    size = np.sqrt(np.maximum((left[near] ** 2 - floor**2).sum(axis=0), 0.0) / counts)
    others = apart & ~near
    rest = np.sqrt(
        (left[others] ** 2).sum(axis=0) / np.maximum(motion.known[others].sum(axis=0), 1)
    )
    if others.sum() < REST * near.sum():
        return None
    joints = [
        int(j)
        for j in np.argsort(-size / least)
        if size[j] > least[j] and rest[j] < REST * floor[j]
    ]
    if not joints:
        return None
    return Moments(
        tuple(j + 1 for j in joints),
        tuple(float(t) + BESIDE for t in motion.time[first]),
        float(near.mean()),
        float(np.abs(left[near, joints[0]]).max()),
    )
