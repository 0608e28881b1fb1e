"""How much better a set of columns explains the torques: Bayesian evidence with the uncertain base
integrated out.

With whitened y = X b + Z z + e, z ~ N(0, 1), e ~ N(0, 1), integrating z replaces the identity by
P = (1 + Z Z^T)^-1, and everything follows from small Gram matrices.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt
from scipy.linalg.lapack import dpotrs, dtrtrs

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.noise import Noise
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.prior import DEPARTURE

Expected = Sequence[tuple[float, float]]
"""usual value and spread of each coefficient"""

BEGINNING = 3.0
"""the same for the response to an unknown state at the beginning of the record"""


@dataclass(frozen=True)
class Score:
    """What a set of columns gains.

    Args:
        gain: log evidence over the base alone [nats].
        coefficients: of the law.
        discrepancy: coefficients of the discrepancy, in units of their own standard deviation.
    """

    gain: float
    coefficients: Array
    discrepancy: Array


class Problem:
    """Whitened torques y (rows, n) against the uncertain base Z (rows, n, k): the ground on which
    laws compete."""

    def __init__(self, y: Array, Z: Array, noise: Sequence[Noise]) -> None:
        # half of the base does not move a joint: links before it, friction of the others
        self._used = [np.flatnonzero(Z[:, j].any(axis=0)) for j in range(len(noise))]
        self._rows = [np.column_stack([Z[:, j, u], y[:, j]]) for j, u in enumerate(self._used)]
        self._whiten(noise, Z.shape[2])

    def under(self, noise: Sequence[Noise]) -> Problem:
        """The same under other noise."""
        other = copy(self)
        other._whiten(noise, len(self.z))
        return other

    def _whiten(self, noise: Sequence[Noise], k: int) -> None:
        self.noise = tuple(noise)
        # y is the column behind Z: one product gives what both say
        self._both = [one.whiten(rows) for one, rows in zip(noise, self._rows, strict=True)]
        gram = np.eye(k)
        self._Zy = np.zeros(k)
        squares = 0.0
        for used, both in zip(self._used, self._both, strict=True):
            products = both.T @ both
            gram[np.ix_(used, used)] += products[:-1, :-1]
            self._Zy[used] += products[:-1, -1]
            squares += float(products[-1, -1])
        # LAPACK itself, without what scipy asks before every call, and in its own order
        self._lower = np.asfortranarray(np.linalg.cholesky(gram))
        self.z = self._beside(self._Zy)
        self.quadratic = squares - float(self._Zy @ self.z)
        """y^T P y"""

    def _beside(self, right: Array) -> Array:
        """(1 + Z^T Z)^-1 right, shape (k,)."""
        return np.asarray(dpotrs(self._lower, right, lower=1)[0])

    def _half(self, C: Array) -> Array:
        """L^-1 C with L L^T = 1 + Z^T Z, shape of C (k, m)."""
        return np.asarray(dtrtrs(self._lower, C, lower=1)[0])

    def _across(self, blocks: Sequence[tuple[int, Array]], m: int) -> tuple[Array, Array]:
        """Z^T X (k, m) and X^T y (m,) of whitened columns (rows, m) of some joints."""
        C = np.zeros((len(self._Zy), m))
        right = np.zeros(m)
        for j, x in blocks:
            products = self._both[j].T @ x
            C[self._used[j]] += products[:-1]
            right += products[-1]
        return C, right

    @property
    def log_evidence(self) -> float:
        """Log evidence of the base alone under this noise, up to a constant that all models
        share."""
        log_weights = sum(float(np.sum(np.log(one.weight))) for one in self.noise)
        return (
            log_weights - 0.5 * self.quadratic - float(np.sum(np.log(np.abs(np.diag(self._lower)))))
        )

    def base_beside(self, torque: Array) -> Array:
        """The base's z once a torque (rows, n) has been taken off y."""
        C, _ = self._across([(j, v[:, None]) for j, v in self._torques(torque)], 1)
        return np.asarray(self.z - self._beside(C[:, 0]))

    def _torques(self, torque: Array) -> list[tuple[int, Array]]:
        """A torque (rows, n), whitened per joint."""
        return [(j, one.whiten(torque[:, j])) for j, one in enumerate(self.noise)]

    def share_beyond_base(self, torque: Array) -> float:
        """Share of a torque (rows, n) that the base with free numbers would not give: X^T P X over
        X^T X."""
        gram, _ = self.projected(
            RegressorColumns(tuple(range(len(self.noise))), torque[:, :, None])
        )
        whole = sum(float(v @ v) for _, v in self._torques(torque))
        return float(gram[0, 0]) / max(whole, 1e-12)

    def whitened(self, columns: RegressorColumns) -> list[tuple[int, Array]]:
        """Filtered columns (rows, joints, k), whitened per joint."""
        return [
            (j, self.noise[j].whiten(columns.values[:, i, :])) for i, j in enumerate(columns.joints)
        ]

    def projected(self, columns: RegressorColumns) -> tuple[Array, Array]:
        """X^T P X (k, k) and X^T P y (k,)."""
        blocks = self.whitened(columns)
        k = columns.values.shape[2]
        gram: Array = sum((x.T @ x for _, x in blocks), np.zeros((k, k)))
        C, right = self._across(blocks, k)
        half = self._half(C)
        return gram - half.T @ half, right - C.T @ self.z

    def projected_in_blocks(
        self, columns: RegressorColumns, place: npt.NDArray[np.intp]
    ) -> tuple[Array, Array]:
        """The same for columns that act in one block of rows after another, `place` (rows,) rising
        from 0.

        The filter's reach across the edges is left out.
        """
        k = columns.values.shape[2]
        count = int(place[-1]) + 1
        gram = np.zeros((count * k, count * k))
        right = np.zeros(count * k)
        C = np.zeros((len(self._Zy), count * k))
        for j, x in self.whitened(columns):
            edges = np.searchsorted(place[self.noise[j].kept], np.arange(count + 1)).tolist()
            across = np.empty((len(self._used[j]) + 1, count * k))
            for block, (start, stop) in enumerate(pairwise(edges)):
                part = slice(block * k, (block + 1) * k)
                gram[part, part] += x[start:stop].T @ x[start:stop]
                across[:, part] = self._both[j][start:stop].T @ x[start:stop]
            C[self._used[j]] += across[:-1]
            right += across[-1]
        half = self._half(C)
        return gram - half.T @ half, right - C.T @ self.z

    def projected_many(self, joint: int, values: Array) -> tuple[Array, Array]:
        """The same for g sets of columns on one joint, values (g, rows, k): (g, k, k) and (g,
        k)."""
        g, rows, k = values.shape
        x = self.noise[joint].whiten(
            np.ascontiguousarray(values.transpose(1, 0, 2)).reshape(rows, g * k)
        )
        C, right = self._across([(joint, x)], g * k)
        half = self._half(C)
        gram = _grams(x, g, k) - _grams(half, g, k)
        right = (right - C.T @ self.z).reshape(g, k)
        return gram, right

    def gains(self, joint: int, blocks: Sequence[Array]) -> Array:
        """Evidence of many sets of columns (rows, k_i) on one joint, shape (len(blocks),)
        [nats]."""
        x = self.noise[joint].whiten(np.hstack(blocks))
        C, right = self._across([(joint, x)], x.shape[1])
        half = self._half(C)
        right = right - C.T @ self.z
        widths = np.array([block.shape[1] for block in blocks])
        stops = np.cumsum(widths)
        found = np.zeros(len(blocks))
        for k in np.unique(widths[widths > 0]):
            places = np.flatnonzero(widths == k)
            parts = [slice(stop - k, stop) for stop in stops[places]]
            grams = [x[:, p].T @ x[:, p] - half[:, p].T @ half[:, p] for p in parts]
            found[places] = law_gains(np.stack(grams), np.stack([right[p] for p in parts]))
        return found

    def score(
        self,
        law: RegressorColumns,
        discrepancy: RegressorColumns | None = None,
        expected: Expected = (),
        shares: Array | None = None,
    ) -> Score:
        """Evidence of a law, with discrepancy of at most about DEPARTURE of its own size.

        Args:
            law, discrepancy: filtered columns on the same joints.
            expected: usual value and spread of the law's coefficients; empty: as flat as the data
                allow (g-prior at its best g).
            shares: allowed size of each departure over the law's; default DEPARTURE.
        """
        k = law.values.shape[2]
        if discrepancy is None or discrepancy.values.shape[2] == 0:
            gram, right = self.projected(law)
            return Score(*law_gain(gram, right, expected), np.zeros(0))
        if discrepancy.joints != law.joints:
            raise ValueError("a law and its discrepancy act on the same joints")
        both = RegressorColumns(
            law.joints, np.concatenate([law.values, discrepancy.values], axis=2)
        )
        gram, right = self.projected(both)
        _, b = law_gain(gram[:k, :k], right[:k], expected)
        unit = discrepancy_unit(law, b, discrepancy, shares)
        d = len(unit)
        scale = np.concatenate([np.ones(k), unit])
        gram = gram * np.outer(scale, scale)
        right = right * scale
        # discrepancy first, with their unit normal prior
        S = np.eye(d) + gram[k:, k:]
        solved = np.linalg.solve(S, np.column_stack([right[k:], gram[k:, :k]]))
        gain_discrepancy = 0.5 * (right[k:] @ solved[:, 0] - np.linalg.slogdet(S)[1])
        left_gram = gram[:k, :k] - gram[:k, k:] @ solved[:, 1:]
        left_right = right[:k] - gram[:k, k:] @ solved[:, 0]
        gain, b = law_gain(left_gram, left_right, expected)
        w = np.asarray(np.linalg.solve(S, right[k:] - gram[k:, :k] @ b))
        return Score(gain + gain_discrepancy, b, w * unit)


def _grams(x: Array, g: int, k: int) -> Array:
    """X^T X of g sets of k columns side by side, x (rows, g k), shape (g, k, k)."""
    found = np.empty((g, k, k))
    for i in range(k):
        for j in range(i + 1):
            found[:, i, j] = found[:, j, i] = np.einsum("mg,mg->g", x[:, i::k], x[:, j::k])
    return found


def discrepancy_shares(kind: str, count: int) -> Array:
    """Allowed size of each departure over the law's own: small for another shape, free for the
    record's beginning."""
    effect = LIBRARY[kind]
    shares = np.full(count, effect.prior.departure)
    if beginnings := effect.beginnings():
        shares[count - beginnings :] = BEGINNING
    return shares


def discrepancy_unit(
    law: RegressorColumns,
    coefficients: Array,
    discrepancy: RegressorColumns,
    shares: Array | None = None,
) -> Array:
    """Standard deviation of each departure's coefficient: its share of the rms torque of the
    law.

    Args:
        law: columns of the basis, filtered [Nm].
        coefficients: of the basis.
        discrepancy: columns of the departures, filtered [Nm].
        shares: of the torque, one each; default the usual one.
    """
    size = np.sqrt(np.mean((law.values @ coefficients) ** 2))
    if shares is not None and (shares == BEGINNING).any():
        # a beginning can show where the law itself hardly does
        least = np.sqrt(np.mean((law.values @ np.ones(len(coefficients))) ** 2))
        size = np.where(shares == BEGINNING, max(size, least), size)
    widths = np.sqrt(np.mean(discrepancy.values**2, axis=(0, 1)))
    return np.asarray((DEPARTURE if shares is None else shares) * size / np.maximum(widths, 1e-12))


def law_gain(gram: Array, right: Array, expected: Expected) -> tuple[float, Array]:
    """Gain and coefficients of columns with their prior."""
    k = len(right)
    if len(expected):
        usual, s = np.array(expected).T
        # the usual torque is taken off first; what is left is a matter of the spread
        offset = float(usual @ (right - 0.5 * gram @ usual))
        right = right - gram @ usual
        inside = np.eye(k) + gram * np.outer(s, s)
        b: Array = s * np.linalg.solve(inside, s * right)
        return offset + 0.5 * float(right @ b - np.linalg.slogdet(inside)[1]), usual + b
    if k == 1:  # most laws; without matrices
        size_of_one = max(float(gram[0, 0]), 0.0) ** 0.5 + 1e-12
        b = right / (float(gram[0, 0]) + 1e-8 * size_of_one**2)
        return float(g_prior_gain(float(right[0] * b[0]), 1)), b
    size = np.sqrt(np.maximum(np.diag(gram), 0.0)) + 1e-12
    normal = gram / np.outer(size, size) + 1e-8 * np.eye(k)
    b = np.linalg.solve(normal, right / size) / size
    return float(g_prior_gain(float(right @ b), k)), b


def law_gains(grams: Array, rights: Array) -> Array:
    """`law_gain` of g sets of columns without knowledge of their sizes: grams (g, k, k), rights (g,
    k), found (g,) [nats]."""
    k = rights.shape[1]
    size = np.sqrt(np.maximum(np.einsum("gii->gi", grams), 0.0)) + 1e-12
    normal = grams / (size[:, :, None] * size[:, None, :]) + 1e-8 * np.eye(k)
    scaled = rights / size
    explained = np.einsum("gi,gi->g", scaled, np.linalg.solve(normal, scaled[..., None])[..., 0])
    return g_prior_gain(explained, k)


def g_prior_gain(explained: float | Array, k: int) -> Array:
    """Log evidence of k columns under Zellner's prior at its best g: (R - k - k log(R / k)) / 2 for
    R > k."""
    R = np.maximum(explained, k)
    return np.asarray(0.5 * (R - k - k * np.log(R / k)))
