"""Resampling to a uniform grid, and the filters that work on one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline, PchipInterpolator
from scipy.ndimage import binary_dilation, convolve1d, correlate1d
from scipy.signal import firwin, savgol_coeffs
from scipy.sparse import csr_matrix

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import positive
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.torque_filter import TorqueFilter

Recorders = Sequence[TorqueFilter | None]
Kept = TypeVar("Kept", bound=np.generic)

MAX_RATE = 250.0
"""[Hz] faster logs are averaged down to this: nothing of an arm's rigid motion lies above a tenth
of it"""
MOST_SAMPLES = 4_000_000
"""on the grid; more come of a gap without end"""
MAX_GAP = 0.025
"""[s] longer gaps are not bridged"""
HALF_WINDOW = 0.040
"""[s] half width of the smoothing before differentiation"""
SMOOTHING = 20.0
"""[Hz] its cut-off"""
MIN_GRID = 200.0
"""[Hz] slower logs are interpolated to this, so that differences are accurate"""


@dataclass(frozen=True)
class UniformLog:
    """A log on a uniform grid. Samples where `valid` is False stand in a gap and hold no
    information.

    Shapes (m,) and (m, n); SI and radians; q_ref only if the log has it.
    """

    time: Array
    q: Array
    tau: Array
    q_ref: Array | None
    valid: Mask
    step: float

    @property
    def rate(self) -> float:
        """Sampling rate [Hz]."""
        return 1.0 / self.step


def resample(log: Log, rate: float | None = None) -> UniformLog:
    """The log on a uniform grid: jitter and short drop-outs interpolated, longer gaps marked.

    Args:
        rate: of the grid [Hz]; default the log's own, but 200 to 250 Hz. A faster log is low-passed
            before.

    Raises:
        InputError: a rate that is not positive, less than two seconds of data, or more than a grid
            may hold.
    """
    own = float(np.clip(log.rate, MIN_GRID, MAX_RATE))
    rate = own if rate is None else positive("rate", rate, "Hz")
    # 249.99 Hz from printed times means 250 Hz
    step = 1.0 / (round(rate, 1) if abs(rate - round(rate)) < 0.05 * rate else rate)
    if log.duration < 2.0:
        raise InputError(f"{log.name}: found {log.duration:.2f} s of data, expected at least 2 s")
    if log.duration / step > MOST_SAMPLES:
        raise InputError(
            f"{log.name}: found {len(log.time)} samples over {log.duration:.3g} s, expected a log "
            f"of at most {MOST_SAMPLES * step:.3g} s on an even grid; cut it at its longest gap"
        )
    time = log.time[0] + step * np.arange(int(np.floor(log.duration / step + 1e-6)) + 1)
    angles = [log.q] + ([] if log.q_ref is None else [log.q_ref])
    stacked = np.hstack([*angles, log.tau])
    at = log.time
    if log.rate > 1.5 / step:
        at, stacked = _decimated(log, stacked, 1.0 / step)
    n = log.n
    even = len(time) == len(at) and np.abs(time - at).max() < 0.05 * step
    on_grid = stacked if even else _interpolated(at, stacked, n, time)
    q_ref = None if log.q_ref is None else on_grid[:, n : 2 * n]
    valid = _covered(log, time, step)
    return UniformLog(time, on_grid[:, :n], on_grid[:, -n:], q_ref, valid, step)


def _interpolated(at: Array, stacked: Array, n: int, time: Array) -> Array:
    """Angles are smooth enough for a spline with a second derivative; the n torques may jump."""
    inside = np.clip(time, at[0], at[-1])
    angles = CubicSpline(at, stacked[:, :-n], axis=0)(inside)
    torques = PchipInterpolator(at, stacked[:, -n:], axis=0)(inside)
    return np.hstack([angles, torques])


def _covered(log: Log, time: Array, step: float) -> Mask:
    """Whether a time lies on a sample of the log, or in a gap short enough to be bridged."""
    following = np.clip(np.searchsorted(log.time, time), 1, len(log.time) - 1)
    after = log.time[following]
    before = log.time[following - 1]
    on_sample = np.minimum(np.abs(after - time), np.abs(time - before)) < 0.25 * step
    return np.asarray((after - before <= max(MAX_GAP, 2.5 / log.rate)) | on_sample)


def _decimated(log: Log, stacked: Array, rate: float) -> tuple[Array, Array]:
    """Low-passed copy of a fast log, still at its own (made even) instants."""
    step = 1.0 / log.rate
    at = log.time[0] + step * np.arange(int(np.floor(log.duration / step)) + 1)
    even = PchipInterpolator(log.time, stacked, axis=0)(at)
    half = int(np.ceil(2.0 * log.rate / rate))
    return at, convolve1d(
        even, firwin(2 * half + 1, 0.4 * rate, fs=log.rate), axis=0, mode="nearest"
    )


def widened(mask: Mask, samples: int) -> Mask:
    """True where a True lies within so many samples along the first axis."""
    if samples == 0 or not mask.any():
        return mask
    reach = np.ones((2 * samples + 1, *[1] * (mask.ndim - 1)), dtype=bool)
    return np.asarray(binary_dilation(mask, reach))


@dataclass(frozen=True)
class LowPass:
    """Zero-phase low-pass of finite length, applied alike to the measured torque and to everything
    it is compared with.

    Args:
        cutoff: [Hz]; step: of the signals [s].
        band: what the signals hold at most where that is less, as a recorder filtered them [Hz].
    """

    cutoff: float
    step: float
    band: float = np.inf

    @property
    def keep(self) -> int:
        """Decimation that the cut-off or the band allows (the output still has 2.5 samples per
        period of it)."""
        highest = min(self.cutoff, self.band)
        return max(1, int(1.0 / (2.5 * highest * self.step) + 1e-9))

    @property
    def half(self) -> int:
        """Half length in samples: outputs nearer than this to a gap or an end are not complete."""
        return int(np.ceil(1.3 / (self.cutoff * self.step)))

    @cached_property
    def weights(self) -> Array:
        """The (symmetric) impulse response, shape (2 half + 1,)."""
        return np.asarray(
            firwin(2 * self.half + 1, self.cutoff, fs=1.0 / self.step, window=("kaiser", 4.0))
        )

    def __call__(self, signal: Array, recorders: Recorders = (None,)) -> Array:
        """Filter along the first axis and keep every `keep`-th sample, from the first complete one
        to the last.

        Args:
            signal: shape (m, ...).
            recorders: what it goes through before.
        """
        (recorder,) = recorders
        rows = _rows_of(self, recorder, len(signal))
        flat = signal.reshape(len(signal), int(np.prod(signal.shape[1:])))
        return np.asarray(rows @ flat).reshape(rows.shape[0], *signal.shape[1:])

    def instants(self, signal: npt.NDArray[Kept]) -> npt.NDArray[Kept]:
        """The kept samples of a signal, not filtered (for time stamps and masks)."""
        return signal[self.half : len(signal) - self.half : self.keep]


@lru_cache(maxsize=8)
def _rows_of(low_pass: LowPass, recorder: TorqueFilter | None, length: int) -> csr_matrix:
    """The filter, behind that of a recorder, on signals of one length as a sparse matrix: only the
    kept outputs are computed."""
    rows = len(low_pass.instants(np.empty(length)))
    before = 0 if recorder is None else recorder.half(low_pass.step)
    weights = low_pass.weights
    if recorder is not None:
        weights = np.convolve(weights, recorder.weights(low_pass.step))
    taps = len(weights)
    place = (np.arange(rows) * low_pass.keep)[:, None] + np.arange(taps) - before
    starts = np.arange(rows + 1) * taps
    # before a log and behind it the recorder saw what it ends on: these weights add up
    place = np.clip(place, 0, length - 1)
    return csr_matrix((np.tile(weights, rows), place.ravel(), starts), shape=(rows, length))


def smoothed(signal: Array, step: float) -> Array:
    """Low-passed at 20 Hz over +-40 ms, zero phase. The first and last `derivative_margin` samples
    are not complete.

    Angles and torques go through the same one, so that what it takes from an acceleration it takes
    from its torque.
    """
    half = max(4, round(HALF_WINDOW / step))
    weights = firwin(
        2 * half + 1, min(SMOOTHING, 0.45 / step), fs=1.0 / step, window=("kaiser", 4.0)
    )
    return np.asarray(convolve1d(signal, weights, axis=0, mode="nearest"))


def polished(signal: Array, step: float) -> Array:
    """Local polynomials of degree 5 over +-40 ms (Savitzky-Golay): takes quantisation off, keeps
    all below 20 Hz."""
    half = max(4, round(HALF_WINDOW / step))
    return np.asarray(convolve1d(signal, savgol_coeffs(2 * half + 1, 5), axis=0, mode="nearest"))


def derivatives(q: Array, step: float, orders: int = 4) -> tuple[Array, ...]:
    """q, qd, qdd… of smoothed angles by central differences of fourth order, each (m, n).

    Args:
        q: [rad], shape (m, n).
        step: between two samples [s].
        orders: how many derivatives.
    """
    found = [q]
    for order in range(1, orders + 1):
        # the second and fourth derivative each from the one two below: fewer neighbours than first
        # differences twice
        stencil = _FIRST / step if order % 2 else _SECOND / step**2
        found.append(
            np.asarray(
                correlate1d(
                    found[order - 1 if order % 2 else order - 2], stencil, axis=0, mode="nearest"
                )
            )
        )
    return tuple(found)


_FIRST = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
_SECOND = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12.0


def derivative_margin(step: float) -> int:
    """Samples at the ends, and beside a gap, that smoothing and differences make incomplete."""
    return max(4, round(HALF_WINDOW / step)) + 6
