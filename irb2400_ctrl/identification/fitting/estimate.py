"""The most probable numbers of an arm given its logs, bodies physically consistent.

    minimise  sum_j (theta^T H_j theta - 2 g_j^T theta) / (sigma_j^2 f)
              + (theta - mean)^T P(kappa) (theta - mean),      theta = (phi(x), beta),  beta_k >= 0

with phi of bodies that can exist (`consistent_fit`), sigma_j the rms of what is left on joint j, f
how many samples say the same thing (integrated correlation; one for all joints, since a joint that
the columns do not describe would otherwise be given up), and kappa the widths of the bodies, by
expectation-maximisation of a Student-t.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.identification.fitting.consistent_fit import consistent_minimum, possible
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.prior import DEGREES_OF_FREEDOM, Prior

MOST_WIDTH = 30.0
"""masses off by 60 %, centres by 15 cm: beyond it something else moves the arm"""
SETTLED = 0.02
"""relative change of noise and widths at which they are done"""
LEAST_WIDTH = 0.5
"""of a body, as a share of what the file states: it is not taken for surer than that"""


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
    correlation: float,
    positive: Mask,
    consistent: bool = True,
    kappa: Array | None = None,
    sigma: Array | None = None,
    start: Estimate | None = None,
    rounds: int = 15,
) -> Estimate:
    """Fit.

    Args:
        correlation: f, samples per independent one.
        positive: columns whose numbers cannot be negative, mask (p,).
        consistent: whether bodies must be possible ones.
        kappa: fixed widths; default fitted.
        sigma: fixed noise [Nm], shape (n,); default what is left.
        start: whose noise and widths to begin with.
    """
    n = len(prior.bodies)
    data = sums.summed()
    count = np.maximum(data.count[0], 1.0)
    mean_square = data.c[0] / count
    widths = np.ones(n) if kappa is None else kappa
    if start is not None:
        widths = start.kappa
    theta = _start(prior, positive)
    noise = np.sqrt(np.maximum(mean_square, 1e-12)) if sigma is None else sigma
    if start is not None:
        noise = start.sigma
    covariance = np.zeros((len(theta), len(theta)))
    for _ in range(rounds):
        A, b = _normal_equations(data, prior, noise, widths, correlation)
        covariance = scaled_inverse(A)
        if consistent:
            theta = consistent_minimum(A, b, n, np.flatnonzero(positive), theta)
        else:
            theta = covariance @ b
        left = data.squared_error(theta)[0] / count
        before = np.concatenate([noise, widths])
        if sigma is None:
            noise = np.sqrt(np.maximum(left, 1e-12 * mean_square + 1e-18))
        if kappa is None:
            nu = DEGREES_OF_FREEDOM
            moved = prior.distance(theta, covariance)
            widths = np.clip(np.sqrt((nu + moved) / (nu + 10.0)), LEAST_WIDTH, MOST_WIDTH)
        # a noise that still falls has not yet let the logs speak
        if np.abs(np.log(np.concatenate([noise, widths]) / before)).max() < SETTLED:
            break
    return Estimate(theta, covariance, noise, widths)


def unbounded_minimum(sums: Moments, prior: Prior, like: Estimate, correlation: float) -> Array:
    """theta without bounds, with the noise and widths of another estimate, shape (p,)."""
    A, b = _normal_equations(sums, prior, like.sigma, like.kappa, correlation)
    return np.asarray(scaled_inverse(A) @ b)


def log_evidence(sums: Moments, prior: Prior, like: Estimate, correlation: float) -> float:
    """How probable the torques are for this layout, whatever its numbers are [nats].

    Laplace's integral over theta (exact without bounds), at the widths of an estimate.
    """
    A, b = _normal_equations(sums, prior, like.sigma, like.kappa, correlation)
    precision = prior.precision(like.kappa)
    square = float((sums.c.sum(axis=0) / like.sigma**2).sum() / correlation)
    square += float(prior.mean @ precision @ prior.mean - b @ scaled_inverse(A) @ b)
    half = 0.5 * DEGREES_OF_FREEDOM
    widths = -2.0 * (half + 1.0) * np.log(like.kappa) - half / like.kappa**2
    spread = 2.0 * float((sums.count.sum(axis=0) * np.log(like.sigma)).sum() / correlation)
    sizes = spread + np.linalg.slogdet(A)[1] - np.linalg.slogdet(precision)[1]
    return float(-0.5 * (square + sizes) + widths.sum())


def _start(prior: Prior, positive: Mask) -> Array:
    """The prior's mean, moved strictly inside what is possible."""
    n = len(prior.bodies)
    theta = prior.mean.copy()
    theta[: 10 * n] = possible(theta[: 10 * n].reshape(n, 10)).ravel()
    places = np.flatnonzero(positive)
    theta[places] = np.maximum(theta[places], 1e-2 * np.sqrt(prior.drives[places - 10 * n]))
    return theta


def _normal_equations(
    sums: Moments, prior: Prior, sigma: Array, widths: Array, correlation: float
) -> tuple[Array, Array]:
    """A, b of 1/2 theta^T A theta - b^T theta."""
    weight = 1.0 / (sigma**2 * correlation)
    precision = prior.precision(widths)
    A = np.einsum("n,bnpq->pq", weight, sums.H) + precision
    b = np.einsum("n,bnp->p", weight, sums.g) + precision @ prior.mean
    return A, b


def scaled_inverse(A: Array) -> Array:
    """Inverse of a positive definite matrix whose rows are of very different sizes."""
    size = 1.0 / np.sqrt(np.diag(A))
    return np.asarray(np.linalg.inv(A * size[:, None] * size) * size[:, None] * size)
