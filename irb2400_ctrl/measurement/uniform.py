"""Resampling to a uniform grid, and the filters that work on one."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import binary_dilation, convolve1d
from scipy.signal import firwin, savgol_coeffs

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.log import Log

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

MAX_RATE = 250.0
"""[Hz] faster logs are averaged down to this: nothing of an arm's rigid motion lies above a tenth of it"""
MAX_GAP = 0.025
"""[s] longer gaps are not bridged"""
HALF_WINDOW = 0.040
"""[s] half width of the local polynomials that give the derivatives"""


@dataclass(frozen=True)
class UniformLog:
    """A log on a uniform grid. Samples where `valid` is False stand in a gap and hold no information.

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
        rate: of the grid [Hz]; default the log's own, at most 250 Hz. A faster log is low-passed before.

    Raises:
        InputError: less than two seconds of data.
    """
    rate = min(log.rate, MAX_RATE) if rate is None else rate
    # 249.99 Hz from printed times means 250 Hz
    step = 1.0 / (round(rate, 1) if abs(rate - round(rate)) < 0.05 * rate else rate)
    if log.duration < 2.0:
        raise InputError(f"{log.name}: found {log.duration:.2f} s of data, expected at least 2 s")
    time = log.time[0] + step * np.arange(int(np.floor(log.duration / step + 1e-6)) + 1)
    columns = [log.q, log.tau] + ([] if log.q_ref is None else [log.q_ref])
    stacked = np.hstack(columns)
    at = log.time
    if log.rate > 1.5 / step:
        at, stacked = _decimated(log, stacked, 1.0 / step)
    even = len(time) == len(at) and np.abs(time - at).max() < 0.05 * step
    on_grid = stacked if even else PchipInterpolator(at, stacked, axis=0)(np.clip(time, at[0], at[-1]))
    after = np.clip(np.searchsorted(log.time, time), 1, len(log.time) - 1)
    gap = log.time[after] - log.time[after - 1]
    on_sample = np.minimum(np.abs(log.time[after] - time), np.abs(time - log.time[after - 1])) < 0.25 * step
    valid = (gap <= max(MAX_GAP, 2.5 * step)) | on_sample
    n = log.n
    q_ref = None if log.q_ref is None else on_grid[:, 2 * n :]
    return UniformLog(time, on_grid[:, :n], on_grid[:, n : 2 * n], q_ref, valid, step)


def _decimated(log: Log, stacked: Array, rate: float) -> tuple[Array, Array]:
    """Low-passed copy of a fast log, still at its own (made even) instants."""
    step = 1.0 / log.rate
    at = log.time[0] + step * np.arange(int(np.floor(log.duration / step)) + 1)
    even = PchipInterpolator(log.time, stacked, axis=0)(at)
    half = int(np.ceil(2.0 * log.rate / rate))
    return at, convolve1d(even, firwin(2 * half + 1, 0.4 * rate, fs=log.rate), axis=0, mode="nearest")


def widened(mask: Mask, samples: int) -> Mask:
    """True where a True lies within so many samples."""
    if samples == 0 or not mask.any():
        return mask
    return np.asarray(binary_dilation(mask, np.ones(2 * samples + 1, dtype=bool)))


@dataclass(frozen=True)
class LowPass:
    """Zero-phase low-pass of finite length, applied alike to the measured torque and to everything it is compared with.

    Args:
        cutoff: [Hz]; step: of the signals [s]; keep: every how many samples the output is kept.
    """

    cutoff: float
    step: float

    @property
    def keep(self) -> int:
        """Decimation that the cut-off allows (the output still has 2.5 samples per period of the cut-off)."""
        return max(1, int(1.0 / (2.5 * self.cutoff * self.step) + 1e-9))

    @property
    def half(self) -> int:
        """Half length in samples: outputs nearer than this to a gap or an end are not complete."""
        return int(np.ceil(1.3 / (self.cutoff * self.step)))

    @property
    def out_step(self) -> float:
        """Step of the output [s]."""
        return self.keep * self.step

    @cached_property
    def weights(self) -> Array:
        """The (symmetric) impulse response, shape (2 half + 1,)."""
        return np.asarray(firwin(2 * self.half + 1, self.cutoff, fs=1.0 / self.step, window=("kaiser", 4.0)))

    def __call__(self, signal: Array) -> Array:
        """Filter along the first axis and keep every `keep`-th sample, from the first complete one to the last."""
        rows = len(self.instants(signal))
        out = np.zeros((rows, *signal.shape[1:]))
        last = (rows - 1) * self.keep + 1
        # only the kept outputs are computed
        for k, weight in enumerate(self.weights):
            out += weight * signal[k : k + last : self.keep]
        return out

    def instants(self, signal: Array) -> Array:
        """The kept samples of a signal, not filtered (for time stamps and masks)."""
        return signal[self.half : len(signal) - self.half : self.keep]


def derivatives(q: Array, step: float, orders: int = 4) -> tuple[Array, ...]:
    """q, qd, qdd… by local polynomials (Savitzky-Golay, degree 5, +-40 ms), each (m, n).

    The first and last `derivative_margin` samples use what is there and are not to be trusted.
    """
    half = derivative_margin(step)
    degree = min(5, 2 * half)
    found = []
    for order in range(orders + 1):
        weights = savgol_coeffs(2 * half + 1, degree, deriv=order, delta=step, use="conv")
        found.append(np.asarray(convolve1d(q, weights, axis=0, mode="nearest")))
    return tuple(found)


def derivative_margin(step: float) -> int:
    """Half width of the local polynomials in samples."""
    return max(4, round(HALF_WINDOW / step))
