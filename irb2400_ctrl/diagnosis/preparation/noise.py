"""Noise of the filtered torques: an autoregressive model per joint, and larger variance around
reversals."""

from __future__ import annotations

from cmath import sqrt
from dataclasses import dataclass
from math import log

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from irb2400_ctrl.arrays import Array, Mask

ORDER = 2
MOST_COLOUR = 4.0
"""largest over geometric mean power density that is believed to be noise"""


@dataclass(frozen=True)
class Noise:
    """Whitening of one joint: e = (r * a) / scale on the rows `kept`, weighted down near reversals.

    Args:
        a: prediction-error filter (1, -a1, …), shape (order + 1,).
        weight: one over the standard deviation of e per kept row.
        kept: indices of rows whose whole filter support is known.
    """

    a: Array
    weight: Array
    kept: npt.NDArray[np.intp]

    def whiten(self, columns: Array) -> Array:
        """(rows, …) -> (kept, …)."""
        flat = columns.reshape(len(columns), -1)
        first = int(self.kept[0]) if len(self.kept) else 0
        gapless = len(self.kept) and first + len(self.kept) - 1 == self.kept[-1]
        # slices are cheaper than gathered rows: of gaps every row is filtered, then the kept ones
        start, stop = (first, first + len(self.kept)) if gapless else (0, len(flat))
        rows = flat[start:stop].copy()
        for lag in range(1, len(self.a)):
            if self.a[lag] != 0.0:
                late = min(max(lag - start, 0), len(rows))
                rows[late:] += self.a[lag] * flat[start + late - lag : stop - lag]
        out = rows if gapless else rows[self.kept]
        out *= self.weight[:, None]
        return out.reshape(-1, *columns.shape[1:])


def without(noise: Noise, rows: Mask) -> Noise:
    """The same noise where some rows do not count."""
    stay = ~rows[noise.kept]
    return Noise(noise.a, noise.weight[stay], noise.kept[stay])


def complete_rows(known: Mask, order: int = ORDER) -> npt.NDArray[np.intp]:
    """Rows that are known and have `order` known rows before them."""
    good = known.copy()
    for lag in range(1, order + 1):
        good[lag:] &= known[:-lag]
        good[:lag] = False
    return np.flatnonzero(good)


def white(residual: Array, known: Mask, reversal: Mask) -> tuple[Noise, ...]:
    """White noise of the level that row-to-row differences show (robust against slow misfit),
    larger near reversals; arguments as of `autoregressive`."""
    each = zip(residual.T, known.T, reversal.T, strict=True)
    return tuple(_white(here, complete_rows(rows), turning) for here, rows, turning in each)


def _white(residual: Array, kept: npt.NDArray[np.intp], reversal: Mask) -> Noise:
    """The same of one joint."""
    a = np.zeros(ORDER + 1)
    a[0] = 1.0
    if len(kept) < 20:
        return Noise(a, np.ones(len(kept)), kept)
    differences = (residual[kept] - residual[kept - 1]) / np.sqrt(2.0)
    calm = ~reversal[kept]
    use = calm if calm.sum() > 20 else np.ones(len(kept), dtype=bool)
    level = max(float(np.median(np.abs(differences[use])) / 0.6745), 1e-9)
    return Noise(a, _weights(differences, level, calm), kept)


def _weights(error: Array, sigma: float, calm: Mask) -> Array:
    """One over the standard deviation, which near reversals is that of the errors there."""
    weight = np.full(len(error), 1.0 / sigma)
    if (~calm).any():
        weight[~calm] = 1.0 / max(float(np.sqrt(np.mean(error[~calm] ** 2))), sigma)
    return weight


def _not_too_coloured(coefficients: Array) -> Array:
    """AR coefficients (ORDER,) drawn towards white until their spectrum spans at most MOST_COLOUR.

    Without this limit whatever the model lacks would pass for slow noise.
    """
    a1, a2 = coefficients.tolist()

    def beyond(share: float) -> float:
        return _colour(share * a1, share**2 * a2) - log(MOST_COLOUR)

    if beyond(1.0) <= 0.0:
        return coefficients
    share = brentq(beyond, 0.0, 1.0, xtol=1e-6)
    return np.array([share * a1, share**2 * a2])


def _colour(a1: float, a2: float) -> float:
    """Log of the largest over the geometric mean power density of 1 / |A|^2,
    A = 1 - a1 z^-1 - a2 z^-2.

    |A|^2 is a parabola in the cosine of the frequency; the mean of its logarithm is that of the
    roots outside the unit circle (Jensen).
    """
    cosines = [-1.0, 1.0]
    if a2 < 0.0 and abs(a1 * (a2 - 1.0)) < -4.0 * a2:
        cosines.append(a1 * (a2 - 1.0) / (4.0 * a2))
    whole = 1.0 + a1**2 + a2**2
    least = min(whole + 2.0 * a1 * (a2 - 1.0) * c - 2.0 * a2 * (2.0 * c**2 - 1.0) for c in cosines)
    root = sqrt(complex(a1**2 + 4.0 * a2))
    outside = [max(abs(a1 + root), 2.0), max(abs(a1 - root), 2.0)]
    return 2.0 * sum(log(0.5 * size) for size in outside) - log(max(least, 1e-12))


def autoregressive(residual: Array, known: Mask, reversal: Mask) -> tuple[Noise, ...]:
    """AR(ORDER) of each joint by least squares on the gap-free rows.

    Args:
        residual: what the model leaves, shape (rows, n) [Nm].
        known: rows that are complete; reversal: rows near a change of direction; both (rows, n).
    """
    kept = [complete_rows(one) for one in known.T]
    # a joint of few rows is taken as white
    return tuple(
        _Fitted(residual[:, j], rows, reversal[:, j]).noise()
        if len(rows) >= 20 * ORDER
        else _white(residual[:, j], rows, reversal[:, j])
        for j, rows in enumerate(kept)
    )


class _Fitted:
    """One joint: the values on its kept rows and before them."""

    def __init__(self, residual: Array, kept: npt.NDArray[np.intp], reversal: Mask) -> None:
        self.kept = kept
        self.past = np.column_stack([residual[kept - lag] for lag in range(1, ORDER + 1)])
        self.now = residual[kept]
        self.calm = ~reversal[kept]
        enough = self.calm.sum() > 20 * ORDER
        self.use = self.calm if enough else np.ones(len(kept), dtype=bool)

    def coefficients(self) -> Array:
        """By least squares, shape (ORDER,)."""
        past = self.past[self.use]
        gram = past.T @ past
        # a little white noise on the diagonal keeps the filter short of an exact predictor
        gram += 1e-3 * np.trace(gram) / ORDER * np.eye(ORDER)
        return np.asarray(np.linalg.solve(gram, past.T @ self.now[self.use]))

    def noise(self) -> Noise:
        """What the coefficients leave is white."""
        coefficients = _not_too_coloured(self.coefficients())
        error = self.now - self.past @ coefficients
        sigma = max(float(np.sqrt(np.mean(error[self.use] ** 2))), 1e-9)
        a = np.append(1.0, -coefficients)
        return Noise(a, _weights(error, sigma, self.calm), self.kept)
