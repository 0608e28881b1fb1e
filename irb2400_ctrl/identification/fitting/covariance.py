"""How uncertain the numbers are, from how the blocks of time disagree (a sandwich)."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.estimate import DOUBT, Estimate, scaled_inverse
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.prior import Prior


def block_covariance(sums: Moments, prior: Prior, numbers: Estimate, correlation: Array) -> Array:
    """Covariance of theta, shape (p, p).

    A^-1 (S + P) A^-1 with A the curvature of the fit, P what the prior says, and S the scatter of
    the blocks' gradients, s_b = sum_j (g_bj - H_bj theta) / (sigma_j^2 f_j). Few blocks cannot tell
    the scatter of many numbers, so S is mixed with what the fit itself expects, as if that were as
    many more blocks as there are numbers determined by the data (Huber 1967; Newey, West 1987).
    The mean of it over the two widths of the bodies that `averaged` takes: either may be so.

    Args:
        sums: of all recordings, block by block.
        prior: of the robot file.
        numbers: the fit.
        correlation: f, samples per independent one, of each joint, shape (n,) [-].
    """
    weight = 1.0 / (numbers.sigma**2 * correlation)
    data = np.einsum("n,bnpq->pq", weight, sums.H)
    precisions = [prior.precision(width * numbers.kappa) for width in (1.0, DOUBT)]
    inverses = [scaled_inverse(data + precision) for precision in precisions]
    gradients = np.einsum("n,bnp->bp", weight, sums.g - sums.H @ numbers.theta)
    full = sums.count.sum(axis=1) > 0
    blocks = int(full.sum())
    determined = float(np.trace(inverses[0] @ data))
    scatter = gradients[full].T @ gradients[full] * blocks / max(blocks - 1, 1)
    mixed = (blocks * scatter + determined * data) / (blocks + determined)
    pairs = zip(inverses, precisions, strict=True)
    each = [inverse @ (mixed + precision) @ inverse for inverse, precision in pairs]
    return np.asarray(np.mean(each, axis=0))
