"""How strongly measured angles are smoothed before they are differentiated: each joint's by what
its motion and its noise make of the acceleration.

An acceleration is w^2 times an angle, so digits of an encoder that nobody sees in the angle may be
most of it, and regressors that hold them are wrong (errors in variables: rotors come out too
small). Of low-passes H the one is taken that leaves the least squared error of the acceleration,

    sum over f of  (1 - H)^2 (S - N) + H^2 N,

S its measured spectrum where that is motion (above 2 N) and N that of the noise: what is lost of
the motion, and kept of the noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import convolve1d, uniform_filter1d
from scipy.signal import firwin, welch

from irb2400_ctrl.arrays import Array, Mask, true_stretches
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.uniform import SMOOTHING, UniformLog, resample, smoothed

LOWEST = 2.0
"""[Hz] an arm moves in what is slower"""
STEPS = 14
"""cut-offs that are tried, from there to `SMOOTHING`"""
LENGTH = 1.3
"""periods of the cut-off in half a window"""
SHARE = 0.05
"""of a log that half a window may be: as much is lost at its ends"""
SEGMENT = 4.0
"""[s] of a spectrum"""
SHORTEST = 1.0
"""[s] without a gap, of which a spectrum tells"""
WIDTH = 1.0
"""[Hz] over which it is taken as even"""
MORE = 2.0
"""times the noise, from which a spectrum holds motion: as much of both; what scatters beside the
noise at high frequencies would else count as such"""
NOTHING = 1e-6
"""[rad/s2] what rounding makes"""
CLEAN = 1e-3
"""noise over all of an acceleration behind the usual filter below which that is as good"""
NOISY = (0.5, 0.9)
"""of the highest frequency that a log holds, between which noise is no more than what is there"""


@dataclass(frozen=True)
class AngleSmoothing:
    """Low-pass of each joint's angles, zero phase.

    Args:
        cutoff: [Hz], (n,); `SMOOTHING` is the usual one. step: of the samples [s].
    """

    cutoff: Array
    step: float

    @property
    def reach(self) -> int:
        """Samples at the ends, and beside a gap, that it makes incomplete beyond the usual ones."""
        lowest = float(self.cutoff.min())
        return 0 if lowest >= SMOOTHING else _half(lowest, self.step)

    def __call__(self, signal: Array) -> Array:
        """Of angles, or what goes along with them, shape (m, n)."""
        found = smoothed(signal, self.step)
        for j in np.flatnonzero(self.cutoff < SMOOTHING):
            found[:, j] = _low_passed(signal[:, j], float(self.cutoff[j]), self.step)
        return found


def angle_smoothing(log: UniformLog, q: Array, even: Log) -> AngleSmoothing:
    """The smoothing that angles on a grid ask for.

    Args:
        log: the grid; q: the angles that are differentiated on it, (m, n) [rad].
        even: the log on its own samples, whose neighbours and digits tell the noise.
    """
    n = q.shape[1]
    usual = AngleSmoothing(np.full(n, SMOOTHING), log.step)
    whole = _longest(log.valid)
    if whole.stop - whole.start < SHORTEST / log.step:
        return usual
    f, shown = _spectrum(q[whole], log.step)
    drawn = _spectrum(white_on_grid(even, log.step)[whole], log.step)[1]
    highest = 0.5 * min(even.rate, log.rate)
    top = (f > NOISY[0] * highest) & (f < NOISY[1] * highest)
    noise = np.median(shown[top] / drawn[top], axis=0) * drawn
    longest = SHARE * float(log.time[-1] - log.time[0])
    lower = np.geomspace(SMOOTHING, LOWEST, STEPS)[1:]
    cutoffs = np.array([SMOOTHING, *lower[LENGTH / lower < longest]])
    passed = np.array([_response(c, log.step, f) for c in cutoffs])
    kept = passed**2 @ noise
    motion = np.where(shown > MORE * noise, shown - noise, 0.0)
    best = cutoffs[np.argmin((1.0 - passed) ** 2 @ motion + kept, axis=0)]
    clean = kept[0] < np.maximum(CLEAN**2 * (passed[0] ** 2 @ shown), NOTHING**2 / f[1])
    return replace(usual, cutoff=np.where(clean, SMOOTHING, best))


def _longest(valid: Mask) -> slice:
    """The longest stretch without a gap."""
    found = true_stretches(valid)
    if not len(found):
        return slice(0, 0)
    start, stop = found[np.argmax(np.diff(found)[:, 0])]
    return slice(int(start), int(stop))


def white_on_grid(even: Log, step: float) -> Array:
    """White noise of size one on the samples of a log, on a grid, (m, 1): on a finer one it is no
    longer white."""
    white = np.random.default_rng(0).standard_normal((len(even.time), 1))
    return resample(Log(even.time, white, white), 1.0 / step).q


def _spectrum(q: Array, step: float) -> tuple[Array, Array]:
    """Frequencies [Hz] and power of the accelerations of angles, shapes (k,), (k, n)."""
    acceleration = np.diff(q, 2, axis=0) / step**2
    count = min(round(SEGMENT / step), len(acceleration))
    f, power = welch(acceleration, 1.0 / step, nperseg=count, axis=0, detrend=False)
    # bins scatter about what they stand for
    return np.asarray(f), uniform_filter1d(power, 1 + 2 * round(0.5 * WIDTH / f[1]), axis=0)


def _half(cutoff: float, step: float) -> int:
    return int(np.ceil(LENGTH / (cutoff * step)))


def _weights(cutoff: float, step: float) -> Array:
    taps = 2 * _half(cutoff, step) + 1
    return np.asarray(firwin(taps, cutoff, fs=1.0 / step, window=("kaiser", 4.0)))


def _low_passed(signal: Array, cutoff: float, step: float) -> Array:
    """A signal (m,) that goes on beyond its ends turned about them: their slope stays."""
    half = _half(cutoff, step)
    wide = np.pad(signal, half, mode="reflect", reflect_type="odd")
    return np.asarray(convolve1d(wide, _weights(cutoff, step))[half : len(wide) - half])


def _response(cutoff: float, step: float, f: Array) -> Array:
    """What is left of a frequency, shape (k,)."""
    if cutoff >= SMOOTHING:
        impulse = np.zeros((2 * round(1.0 / step) + 1, 1))
        impulse[len(impulse) // 2] = 1.0
        weights = smoothed(impulse, step)[:, 0]
    else:
        weights = _weights(cutoff, step)
    place = np.arange(len(weights)) - len(weights) // 2
    return np.asarray(np.cos(2.0 * np.pi * np.outer(f, place) * step) @ weights)
