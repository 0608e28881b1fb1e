"""How much more than its neighbours one joint reads of the torque: several joints feel the same
bodies, so that torque channels of different gains agree on none.

    tau_j = gamma_j Y_j phi + D_j beta_j,      gamma_j ~ N(1, USUAL^2)

A common factor of all channels is a factor of the bodies; only what the joints have apart is told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.cross_validation import FOLDS
from irb2400_ctrl.identification.fitting.estimate import scaled_inverse
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Moments

USUAL = 0.15
"""spread of torque constants about what a file states"""
ASIDE = 100.0
"""width of the bodies at which the file hardly counts"""
FEWEST_JOINTS = 3
"""that feel the same bodies, for the middle one to be right"""
CLEAR = 4.0
"""standard errors from one"""
LEAST = 0.05
"""by which a gain is off one, to be said"""
EXACT = 0.02
"""standard error up to which the other gains are taken as found, once one is clear"""
LESS = 0.8
"""of what the joint leaves on unseen stretches, with gains"""
NOTHING = 1e-18
"""[Nm2] what a joint that rests leaves"""
ROUNDS = 12


@dataclass(frozen=True)
class _Solution:
    """Numbers (p,), gains (n,) and their covariance (n, n)."""

    theta: Array
    gains: Array
    covariance: Array


def relative_gains(found: Fit) -> tuple[Array, Array]:
    """Gains of the channels over the middle one of them, and their standard errors, (n,) [-]; one
    and infinity where none is clearly another, and beside such a one for those known to less.

    Args:
        found: a fit, with the columns that it has taken on.
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
            total += _squared(found, unseen, _solved(found, seen, free=free))
    better = np.log(np.maximum(left[True], NOTHING) / np.maximum(left[False], NOTHING))
    if better.sum() >= 0.0 or not (clear & (better < 2.0 * np.log(LESS))).any():
        return np.ones(n), np.full(n, np.inf)
    known = clear | (errors < EXACT)
    return np.where(known, gains, 1.0), np.where(known, errors, np.inf)


def _scaled(found: Fit, data: Moments, gains: Array) -> tuple[Array, Array]:
    """H (n, p, p) and g (n, p) with the bodies' columns of each joint times its gain.

    Args:
        found: whose columns they are; data: one block; gains: (n,).
    """
    scale = np.ones((found.layout.n, found.layout.count))
    scale[:, : found.layout.inertial] = gains[:, None]
    return data.H[0] * scale[:, :, None] * scale[:, None, :], data.g[0] * scale


def _squared(found: Fit, data: Moments, solution: _Solution) -> Array:
    """Sum of squares that a solution leaves, of each joint, (n,).

    Args:
        found: whose columns they are; data: one block; solution: of these or other samples.
    """
    H, g = _scaled(found, data, solution.gains)
    theta = solution.theta
    quadratic = np.einsum("npq,p,q->n", H, theta, theta, optimize=True)
    return np.asarray(np.maximum(quadratic - 2.0 * g @ theta + data.c[0], 0.0))


def _solved(found: Fit, data: Moments, *, free: bool) -> _Solution:
    """Gauss-Newton over all numbers and, where `free`, the gains.

    Args:
        found: whose columns, noise and prior they are; data: one block; free: else they are one.
    """
    layout = found.layout
    n = layout.n
    p = layout.count
    prior = found.prior
    precision = prior.precision(np.full(n, ASIDE))
    bodies = slice(0, layout.inertial)
    sigma = np.maximum(found.free.sigma, 1e-9)
    count = np.maximum(data.count[0], 1.0)
    gains = np.ones(n)
    theta = np.array(prior.mean)
    covariance = np.zeros((p + n, p + n))
    for turn in range(ROUNDS):
        weight = 1.0 / (sigma**2 * found.correlation)
        H, g = _scaled(found, data, gains)
        A = np.zeros((p + n, p + n))
        b = np.zeros(p + n)
        A[:p, :p] = np.einsum("n,npq->pq", weight, H) + precision
        b[:p] = weight @ (g - H @ theta) + precision @ (prior.mean - theta)
        A[range(p, p + n), range(p, p + n)] = 1.0 / USUAL**2
        b[p:] = (1.0 - gains) / USUAL**2
        # the first turn finds the bodies
        if free and turn > 0:
            # d tau_j / d gamma_j = Y_j phi: the bodies' columns over the gain, times phi
            alone = np.zeros((n, p))
            alone[:, bodies] = theta[bodies] / gains[:, None]
            curved = np.einsum("npq,nq->np", H, alone)
            cross = weight[:, None] * curved
            A[p:, :p] = cross
            A[:p, p:] = cross.T
            A[range(p, p + n), range(p, p + n)] += np.einsum("np,np->n", cross, alone)
            b[p:] += np.einsum("n,np,np->n", weight, g - H @ theta, alone)
        covariance = scaled_inverse(A)
        step = covariance @ b
        theta = theta + step[:p]
        gains = np.clip(gains + step[p:], 0.2, 5.0)
        solution = _Solution(theta, gains, covariance[p:, p:])
        sigma = np.sqrt(np.maximum(_squared(found, data, solution) / count, 1e-18))
    return solution
