"""How much more than its neighbours one joint reads of the torque: several joints feel the same
bodies, so that torque channels of different gains agree on none.

    tau_j = gamma_j Y_j phi + D_j beta_j,      gamma_j ~ N(1, USUAL^2)

A common factor of all channels is a factor of the bodies; only what the joints have apart is told.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.cross_validation import FOLDS
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.identification.fitting.fit import ASIDE
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.noise import NOTHING

USUAL = 0.15
"""spread of torque constants about what a file states"""
FEWEST_JOINTS = 3
"""that feel the same bodies, for the middle one to be right"""
CLEAR = 4.0
"""standard errors from one"""
LEAST = 0.05
"""by which a gain is off one, to be said"""
BESIDE = 2.0
"""the same for the other gains, once one is clear: constants that were taken from elsewhere are
seldom wrong alone"""
EXACT = 0.02
"""standard error up to which these are taken as found, whatever they are"""
LESS = 0.8
"""of what some joint leaves on unseen stretches, with gains: not always one whose gain is off"""
POSSIBLE = (0.2, 5.0)
"""gains within which it is looked for"""
ROUNDS = 12


@dataclass(frozen=True)
class _Solution:
    """Numbers (p,), gains (n,) and their covariance (n, n)."""

    theta: Array
    gains: Array
    covariance: Array


def relative_gains(found: Fit) -> tuple[Array, Array]:
    """Gains of the channels over the middle one of them, and their standard errors, (n,) [-]; one
    and infinity where none is clearly another, and beside such a one for those that tell nothing.
    """
    n = found.layout.n
    blocks = found.sums.gathered(FOLDS)
    whole = _solved(found, blocks.summed(), free=True)
    gains = whole.gains / np.median(whole.gains)
    # what all share is the bodies'
    apart = (np.eye(n) - 1.0 / n) / whole.gains
    errors = gains * np.sqrt(np.diag(apart @ whole.covariance @ apart.T))
    off = np.abs(gains - 1.0)
    clear = (off > LEAST) & (off > CLEAR * errors)
    if n < FEWEST_JOINTS or len(blocks.count) < FOLDS or not clear.any():
        return np.ones(n), np.full(n, np.inf)
    left = {free: np.zeros(n) for free in (True, False)}
    every = np.arange(FOLDS)
    for fold in every:
        seen = blocks.taken(every[every != fold]).summed()
        unseen = blocks.taken(np.array([fold]))
        for free, total in left.items():
            solution = _solved(found, seen, free=free)
            total += _over_gains(found, unseen, solution.gains).squared_error(solution.theta)[0]
    rms = {free: np.sqrt(np.maximum(squares, NOTHING**2)) for free, squares in left.items()}
    better = np.log(rms[True] / rms[False])
    if better.sum() >= 0.0 or not (better < np.log(LESS)).any():
        return np.ones(n), np.full(n, np.inf)
    known = (off > BESIDE * errors) | (errors < EXACT)
    return np.where(known, gains, 1.0), np.where(known, errors, np.inf)


def _over_gains(found: Fit, data: Moments, gains: Array) -> Moments:
    """The sums with the bodies' columns of each joint times its gain."""
    scale = np.ones((found.layout.n, found.layout.count))
    scale[:, : found.layout.inertial] = gains[:, None]
    H = data.H * scale[:, :, None] * scale[:, None, :]
    return replace(data, H=H, g=data.g * scale)


def _solved(found: Fit, data: Moments, *, free: bool) -> _Solution:
    """Gauss-Newton over all numbers and, where `free`, the gains."""
    n = found.layout.n
    p = found.layout.count
    bodies = slice(0, found.layout.inertial)
    mean = found.prior.mean
    precision = found.prior.precision(np.full(n, ASIDE))
    apart = np.arange(p, p + n)
    count = np.maximum(data.count[0], 1.0)
    sigma = np.maximum(found.free.sigma, NOTHING)
    gains = np.ones(n)
    theta = np.array(mean)
    covariance = np.zeros((p + n, p + n))
    for turn in range(ROUNDS):
        weight = 1.0 / (sigma**2 * found.correlation)
        sums = _over_gains(found, data, gains)
        H = sums.H[0]
        left = sums.g[0] - H @ theta
        A = np.zeros((p + n, p + n))
        A[:p, :p] = np.einsum("n,npq->pq", weight, H) + precision
        A[apart, apart] = 1.0 / USUAL**2
        b = np.concatenate([weight @ left + precision @ (mean - theta), (1.0 - gains) / USUAL**2])
        # the first turn finds the bodies
        if free and turn > 0:
            # d tau_j / d gamma_j = Y_j phi: the bodies' columns over the gain, times phi
            alone = np.zeros((n, p))
            alone[:, bodies] = theta[bodies] / gains[:, None]
            cross = weight[:, None] * np.einsum("npq,nq->np", H, alone)
            A[p:, :p] = cross
            A[:p, p:] = cross.T
            A[apart, apart] += np.einsum("np,np->n", cross, alone)
            b[p:] += weight * np.einsum("np,np->n", left, alone)
        covariance = scaled_inverse(A)
        step = covariance @ b
        theta = theta + step[:p]
        gains = np.clip(gains + step[p:], *POSSIBLE)
        squares = _over_gains(found, data, gains).squared_error(theta)[0]
        sigma = np.sqrt(np.maximum(squares / count, NOTHING**2))
    return _Solution(theta, gains, covariance[p:, p:])
