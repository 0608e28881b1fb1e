"""How uncertain the numbers are, from how the blocks of time disagree (a sandwich)."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.estimate import Estimate, scaled_inverse
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.prior import Prior


def block_covariance(sums: Moments, prior: Prior, numbers: Estimate, correlation: Array) -> Array:
    """Covariance of theta, shape (p, p).

    A^-1 (S + P) A^-1 with A the curvature of the fit, P what the prior says, and S the scatter of
    the blocks' gradients, s_b = sum_j (g_bj - H_bj theta) / (sigma_j^2 f_j). Few blocks cannot tell
    the scatter of many numbers, so S is mixed with what the fit itself expects, as if that were as
    many more blocks as there are numbers determined by the data (Huber 1967; Newey, West 1987).

    Args:
        sums: of all recordings, block by block.
        prior: of the robot file.
        numbers: the fit.
        correlation: f, samples per independent one, of each joint, shape (n,) [-].
    """
    weight = 1.0 / (numbers.sigma**2 * correlation)
    data = np.einsum("n,bnpq->pq", weight, sums.H)
    precision = prior.precision(numbers.kappa)
    inverse = scaled_inverse(data + precision)
    gradients = np.einsum("n,bnp->bp", weight, sums.g - sums.H @ numbers.theta)
    full = sums.count.sum(axis=1) > 0
    blocks = int(full.sum())
    determined = float(np.trace(inverse @ data))
    scatter = gradients[full].T @ gradients[full] * blocks / max(blocks - 1, 1)
    mixed = (blocks * scatter + determined * data) / (blocks + determined)
    return np.asarray(inverse @ (mixed + precision) @ inverse)
