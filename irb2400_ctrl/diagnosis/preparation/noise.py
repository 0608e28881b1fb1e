"""Noise of the filtered torques: an autoregressive model per joint, and larger variance around
reversals."""

from __future__ import annotations

import cmath
from dataclasses import dataclass

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
        order = len(self.a) - 1
        flat = columns.reshape(len(columns), -1)
        # on every row, then the kept ones: slices are cheaper than gathered rows
        every = self.a[0] * flat
        for lag in range(1, order + 1):
            if self.a[lag] != 0.0:
                every[lag:] += self.a[lag] * flat[:-lag]
        out = every[self.kept]
        out *= self.weight[:, None]
        return np.asarray(out).reshape(-1, *columns.shape[1:])


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


def white(residual: Array, known: Mask, reversal: Mask) -> Noise:
    """White noise of the level that row-to-row differences show (robust against slow misfit),
    larger near reversals."""
    kept = complete_rows(known)
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
    """The AR coefficients, drawn towards white until the spectrum spans at most MOST_COLOUR.

    Without this limit whatever the model lacks would pass for slow noise.
    """
    first, second = (float(a) for a in coefficients)
    if _span(first, second) <= MOST_COLOUR:
        return coefficients
    inside = float(
        brentq(lambda s: _span(first * s, second * s**2) - MOST_COLOUR, 0.0, 1.0, xtol=1e-9)
    )
    return np.array([first * inside, second * inside**2])


def _span(first: float, second: float) -> float:
    """Largest over geometric mean power density of AR coefficients of order 2.

    With c = cos w the density is one over |1 - a1 e^-iw - a2 e^-2iw|^2 = (1 + a2)^2 + a1^2 - 2 a1
    (1 - a2) c - 4 a2 c^2, whose geometric mean is that of the roots outside the unit circle
    (Jensen's formula).
    """
    turns = [-1.0, 1.0]
    if second < 0.0 and abs(first * (1.0 - second)) < -4.0 * second:
        turns.append(-first * (1.0 - second) / (4.0 * second))
    least = min(
        (1.0 + second) ** 2 + first**2 - 2.0 * first * (1.0 - second) * c - 4.0 * second * c**2
        for c in turns
    )
    root = cmath.sqrt(first**2 + 4.0 * second)
    outside = [max(1.0, abs(first + side * root) / 2.0) for side in (1.0, -1.0)]
    return float((outside[0] * outside[1]) ** 2 / max(least, 1e-300))


def autoregressive(residual: Array, known: Mask, reversal: Mask, floor: float = 0.0) -> Noise:
    """AR(ORDER) by least squares on the gap-free rows.

    Args:
        residual: what the model leaves, shape (rows,) [Nm].
        known: rows that are complete; reversal: rows near a change of direction.
        floor: smallest standard deviation of the innovation [Nm].
    """
    kept = complete_rows(known)
    if len(kept) < 20 * ORDER:
        return white(residual, known, reversal)
    past = np.column_stack([residual[kept - lag] for lag in range(1, ORDER + 1)])
    now = residual[kept]
    calm = ~reversal[kept]
    use = calm if calm.sum() > 20 * ORDER else np.ones(len(kept), dtype=bool)
    # a little white noise on the diagonal keeps the filter short of an exact predictor
    gram = past[use].T @ past[use]
    gram += 1e-3 * np.trace(gram) / ORDER * np.eye(ORDER)
    coefficients = _not_too_coloured(np.linalg.solve(gram, past[use].T @ now[use]))
    error = now - past @ coefficients
    sigma = max(float(np.sqrt(np.mean(error[use] ** 2))), floor, 1e-9)
    return Noise(np.append(1.0, -coefficients), _weights(error, sigma, calm), kept)
