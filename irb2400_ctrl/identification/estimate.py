"""The most probable numbers of an arm given its logs, bodies physically consistent.

    minimise  sum_j (theta^T H_j theta - 2 g_j^T theta) / (sigma_j^2 f_j)
              + (theta - mean)^T P(kappa) (theta - mean),      theta = (phi(x), beta),  beta_k >= 0

with phi of bodies that can exist (`consistent_fit`), sigma_j the rms of what is left on joint j, f_j how many samples say
the same thing (integrated correlation), and kappa the widths of the bodies, by
expectation-maximisation of a Student-t.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.consistent_fit import consistent_minimum, possible
from irb2400_ctrl.identification.moments import Moments
from irb2400_ctrl.identification.prior import DEGREES_OF_FREEDOM, Prior


@dataclass(frozen=True)
class Estimate:
    """Numbers of the columns, their covariance, the noise that is left and the bodies' widths.

    Args:
        theta: (p,); covariance: (p, p); sigma: (n,) [Nm]; kappa: (n,).
    """

    theta: Array
    covariance: Array
    sigma: Array
    kappa: Array


def estimate(
    sums: Moments,
    prior: Prior,
    *,
    correlation: Array,
    positive: Array,
    consistent: bool = True,
    kappa: Array | None = None,
    rounds: int = 12,
) -> Estimate:
    """Fit.

    Args:
        correlation: f_j, samples per independent one, shape (n,).
        positive: columns whose numbers cannot be negative, mask (p,).
        consistent: whether bodies must be possible ones.
        kappa: fixed widths; default fitted.
    """
    n = len(prior.bodies)
    H = sums.H.sum(axis=0)
    g = sums.g.sum(axis=0)
    c = sums.c.sum(axis=0)
    count = np.maximum(sums.count.sum(axis=0), 1.0)
    widths = np.ones(n) if kappa is None else kappa
    theta = prior.mean.copy()
    sigma = np.sqrt(np.maximum(c / count, 1e-12))
    covariance = np.zeros((len(theta), len(theta)))
    theta[: 10 * n] = possible(theta[: 10 * n].reshape(n, 10)).ravel()
    places = np.flatnonzero(positive)
    theta[places] = np.maximum(theta[places], 1e-2 * np.sqrt(prior.drives[places - 10 * n]))
    for _ in range(rounds):
        weight = 1.0 / (sigma**2 * correlation)
        precision = prior.precision(widths)
        A = np.einsum("n,npq->pq", weight, H) + precision
        b = weight @ g + precision @ prior.mean
        covariance = _scaled_inverse(A)
        if consistent:
            theta = consistent_minimum(A, b, n, places, theta)
        else:
            theta = covariance @ b
        left = np.einsum("npq,p,q->n", H, theta, theta) - 2 * g @ theta + c
        sigma = np.sqrt(np.maximum(left / count, 1e-12 * c / count + 1e-18))
        if kappa is None:
            nu = DEGREES_OF_FREEDOM
            moved = prior.distance(theta, covariance)
            widths = np.maximum(np.sqrt((nu + moved) / (nu + 10.0)), 0.5)
    return Estimate(theta, covariance, sigma, widths)


def _scaled_inverse(A: Array) -> Array:
    size = 1.0 / np.sqrt(np.diag(A))
    return np.asarray(np.linalg.inv(A * size[:, None] * size) * size[:, None] * size)
