"""Noise of the filtered torques: an autoregressive model per joint, larger variance around
reversals, and what an identification of the arm leaves of any motion (Kennedy and O'Hagan)."""

from __future__ import annotations

from cmath import sqrt
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import log

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.measurement.prepared_log import PreparedLog

ORDER = 2
"""of the filter; `_colour` is that of two coefficients"""
MOST_COLOUR = 4.0
"""largest over geometric mean power density that is believed to be noise"""
FINEST = 1e-4
"""share of a joint's rms torque that is called noise at least: a log that was made of the model has
none, and is right to what derivatives of its angles are worth"""
LEAST = 1e-9
"""[Nm] where there is no torque"""
SLOW = 0.3
"""[s] over which what a model of an arm leaves of a motion stays what it is"""
FEWEST = 20
"""rows, of fewer nothing is known of a joint's noise: it rests"""
HELD = 1.0
"""[s] over which the friction of a joint that rests stays what it is"""
_TURNS = np.exp(-1j * np.outer(np.arange(1, ORDER + 1), 2.0 * np.pi * np.arange(256) / 256))


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


@dataclass(frozen=True)
class NoiseModel:
    """What passes for noise of the filtered torques of a log.

    Args:
        known: rows that are complete; reversal: rows near a change of direction; both (rows, n).
        wander: rms of what a model of this very arm leaves of a motion, slowly and by no law,
            shape (n,) [Nm]. It is not estimated from the log: there it is what a law may explain.
        step: between two rows [s].
        least: that noise is taken for, shape (n,) or one for all [Nm].
        holds: what dry friction holds of a joint that rests, shape (n,) [Nm]; without it, and where
            it is infinite, nothing is known of such a joint.
    """

    known: Mask
    reversal: Mask
    wander: Array
    step: float
    least: Array | float = LEAST
    holds: Array | None = None

    @classmethod
    def of(
        cls, motion: PreparedLog, reversal: Mask, wander: Array, holds: Array | None = None
    ) -> NoiseModel:
        """Of one log.

        Args:
            motion: prepared; reversal, wander, holds: as of the class.
        """
        step = float(np.median(np.diff(motion.row_time)))
        least = FINEST * rms(motion.tau) + LEAST
        return cls(motion.row_known, reversal, wander, step, least, holds)

    def white(self, residual: Array) -> tuple[Noise, ...]:
        """White noise of the level that row-to-row differences show (robust against slow misfit),
        larger near reversals; `residual`: what the model leaves, shape (rows, n) [Nm]."""
        each = zip(residual.T, self._kept, self.reversal.T, self._least, strict=True)
        return self._with_resting(
            _white(here, rows, turning, least) for here, rows, turning, least in each
        )

    def coloured(self, residual: Array) -> tuple[Noise, ...]:
        """AR(ORDER) of each joint by least squares on the gap-free rows, of few rows white, and
        what is left of any motion; argument as of `white`."""
        per_joint = (residual.T, self._kept, self.reversal.T, self._least, self.wander)
        return self._with_resting(
            _Fitted(here, rows, turning).noise(least, wander, self.step)
            if len(rows) >= 20 * ORDER
            else _white(here, rows, turning, least, wander)
            for here, rows, turning, least, wander in zip(*per_joint, strict=True)
        )

    def _with_resting(self, found: Iterable[Noise]) -> tuple[Noise, ...]:
        """Of joints that rest what friction holds: one value in each `HELD`."""
        if self.holds is None:
            return tuple(found)
        complete = np.flatnonzero(self.known.any(axis=1))
        white = np.eye(1, ORDER + 1)[0]
        share = np.sqrt(min(self.step / HELD, 1.0))
        return tuple(
            Noise(white, np.full(len(complete), share / holds), complete) if witness else one
            for one, holds, witness in zip(
                found, self.holds, rests(self.known) & np.isfinite(self.holds), strict=True
            )
        )

    @property
    def _least(self) -> Array:
        return np.broadcast_to(self.least, len(self._kept))

    @cached_property
    def _kept(self) -> list[npt.NDArray[np.intp]]:
        return [complete_rows(rows) for rows in self.known.T]


def rests(known: Mask) -> Mask:
    """Joints of which a log determines next to no row, shape (n,); `known`: (rows, n)."""
    return np.asarray(known.sum(axis=0) < FEWEST)


def complete_rows(known: Mask, order: int = ORDER) -> npt.NDArray[np.intp]:
    """Rows that are known and have `order` known rows before them."""
    good = known.copy()
    for lag in range(1, order + 1):
        good[lag:] &= known[:-lag]
        good[:lag] = False
    return np.flatnonzero(good)


def _white(
    residual: Array, kept: npt.NDArray[np.intp], reversal: Mask, least: float, wander: float = 0.0
) -> Noise:
    """White noise of one joint, and a wander [Nm].

    Args:
        residual, reversal: of the joint, shape (rows,); kept: its rows.
        least, wander: as of `NoiseModel`.
    """
    a = np.zeros(ORDER + 1)
    a[0] = 1.0
    if len(kept) < FEWEST:
        return Noise(a, np.ones(len(kept)), kept)
    differences = (residual[kept] - residual[kept - 1]) / np.sqrt(2.0)
    calm = ~reversal[kept]
    use = calm if calm.sum() > 20 else np.ones(len(kept), dtype=bool)
    level = max(float(np.hypot(np.median(np.abs(differences[use])) / 0.6745, wander)), least)
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

    def noise(self, least: float, wander: float, step: float) -> Noise:
        """What the coefficients leave is white, of at least `least` [Nm]; `wander` is noise too.

        Args:
            least, wander, step: as of `NoiseModel`.
        """
        coefficients = _not_too_coloured(self.coefficients())
        error = self.now - self.past @ coefficients
        sigma = float(np.sqrt(np.mean(error[self.use] ** 2)))
        if wander > 0.0:
            coefficients, sigma = _with_wander(coefficients, sigma, wander, step)
            error = self.now - self.past @ coefficients
        a = np.append(1.0, -coefficients)
        return Noise(a, _weights(error, max(sigma, least), self.calm), self.kept)


def _with_wander(
    coefficients: Array, sigma: float, wander: float, step: float
) -> tuple[Array, float]:
    """AR coefficients (ORDER,) and standard deviation of the errors of noise and a slow wander
    together: their power densities add, and the autocovariance of the sum gives both
    (Yule-Walker).

    Args:
        coefficients: of the noise; sigma: of its errors [Nm].
        wander: rms [Nm], correlated as exp(-t / SLOW); step: between two samples [s].
    """
    stays = np.exp(-step / SLOW)
    slow = wander**2 * (1.0 - stays**2) / np.abs(1.0 - stays * _TURNS[0]) ** 2
    power = sigma**2 / np.abs(1.0 - coefficients @ _TURNS) ** 2 + slow
    r = np.concatenate([[power.mean()], (_TURNS.real @ power) / power.size])
    found = np.linalg.solve(r[np.abs(np.subtract.outer(range(ORDER), range(ORDER)))], r[1:])
    return found, float(np.sqrt(max(r[0] - found @ r[1:], sigma**2)))
