"""What a residual goes with: the two tests that system identification asks of it (L. Ljung, *System
identification*, 2nd ed., section 16.6).

Whiteness: a sample of what is left says nothing about the next one. Independence: what is left does
not go with the motion. Where it does, physics is missing there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask

SURE = 2.576
"""standard deviations that white noise leaves in one case of a hundred only"""
SMOOTH = 15
"""lines of a spectrum that are averaged: of a motion of few frequencies the residual has none left
at just these"""
NOTABLE = 0.1
"""correlation below which a signal explains less than 1 % of what is left"""


@dataclass(frozen=True)
class Dependence:
    """How much of a residual goes with a signal.

    Args:
        signal: its name.
        correlation: from -1 to 1.
        chance: what a signal that has nothing to do with it stays below in 19 of 20 cases (2.58
            standard deviations, with spectra that are estimated from the same record).
    """

    signal: str
    correlation: float
    chance: float

    @property
    def notable(self) -> bool:
        """More than by chance, and enough to matter."""
        return bool(abs(self.correlation) > max(self.chance, NOTABLE))


def autocorrelation(left: Array, lags: int) -> Array:
    """Correlation of a residual with itself, lag 0 to `lags` samples later, shape (lags + 1,).

    Args:
        left: residual [Nm], shape (m,); gaps as NaN, and pairs with a gap do not count.
        lags: samples.
    """
    known = np.isfinite(left)
    centred = np.where(known, left - np.mean(left[known]), 0.0)
    weight = known.astype(float)
    m = len(left)
    found = np.full(lags + 1, np.nan)
    for k in range(min(lags, m - 1) + 1):
        pairs = weight[: m - k] @ weight[k:]
        if pairs > 0:
            found[k] = centred[: m - k] @ centred[k:] / pairs
    return np.asarray(found / found[0])


def white_band(left: Array) -> float:
    """Autocorrelation that white noise stays below at 99 of 100 lags: 2.58/sqrt(samples)."""
    return SURE / float(np.sqrt(np.isfinite(left).sum()))


def dependences(left: Array, signals: Mapping[str, Array], rate: float) -> list[Dependence]:
    """How much a residual goes with each signal at the same time.

    By chance the correlation of two independent signals has the variance sum_k r_e(k) r_u(k) / m:
    slow signals agree by chance more often than noise. The sum is taken over the spectra of the
    signal and of the residual without what goes with the signal.

    Args:
        left: residual [Nm], shape (m,), gaps as NaN.
        signals: each (m,).
        rate: samples per second [1/s].
    """
    from scipy.signal import periodogram

    known = np.isfinite(left)
    error = np.where(known, left - np.mean(left[known]), 0.0)
    found = []
    for name, values in signals.items():
        signal = np.where(known, values - np.mean(values[known]), 0.0)
        size = float((error @ error) * (signal @ signal))
        if size == 0.0:
            found.append(Dependence(name, 0.0, 1.0))
            continue
        slope = (error @ signal) / (signal @ signal)
        _, power = periodogram(error - slope * signal, fs=rate, detrend=False)
        power = np.convolve(power, np.ones(SMOOTH) / SMOOTH, mode="same")
        frequency, other = periodogram(signal, fs=rate, detrend=False)
        common = 0.5 * rate * float(np.sum(power * other)) * float(frequency[1])
        variance = common * len(left) ** 2 / float(known.sum()) / size
        correlation = float(error @ signal) / np.sqrt(size)
        found.append(Dependence(name, correlation, min(SURE * float(np.sqrt(variance)), 1.0)))
    return found


def fit_percent(measured: Array, modelled: Array, known: Mask) -> Array:
    """How much of a torque's variation the model makes, 100 (1 - |y - y^| / |y - mean(y)|), (n,).

    Args:
        measured, modelled: torque [Nm], shape (m, n).
        known: samples that count, (m, n).
    """
    count = np.maximum(known.sum(axis=0), 1)
    centre = np.where(known, measured, 0.0).sum(axis=0) / count
    off = np.where(known, measured - modelled, 0.0)
    spread = np.where(known, measured - centre, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.linalg.norm(off, axis=0) / np.linalg.norm(spread, axis=0)
    return np.asarray(100.0 * (1.0 - ratio))
