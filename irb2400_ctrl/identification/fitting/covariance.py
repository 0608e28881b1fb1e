"""How uncertain the numbers are, from how the blocks of time disagree (a sandwich)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.estimate import DOUBT, Estimate, scaled_inverse
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Moments, Recording
from irb2400_ctrl.identification.fitting.prior import Prior

USUAL_DAYS = 0.3
"""of its size, by which the friction of one log is another: what a log hardly tells is not far"""


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


def open_between_logs(found: Fit, parts: Sequence[Recording]) -> Array:
    """What the friction of a joint scatters by from log to log, beyond noise, as a covariance,
    shape (p, p): how surely that of another day is known. Blocks of one log are of one day.

    d_k = (H_k + P)^-1 (g_k - H_k theta) of Coulomb and viscous friction of a joint in log k, N_k
    its covariance by noise, P what friction usually does:  sum d_k d_k^T / (K - 1) - mean N_k.
    """
    open_still = np.zeros((found.layout.count,) * 2)
    if len(parts) < 2:
        return open_still
    logs = [found.sums.taken(np.unique(part.block)).summed() for part in parts]
    own = np.arange(found.layout.count)
    terms = (own[found.layout.drive(term)] for term in ("coulomb", "viscous"))
    noise = found.numbers.sigma**2 * found.samples
    for j, place in enumerate(zip(*terms, strict=True)):
        pair = np.array(place)
        usual = USUAL_DAYS * np.maximum(found.theta[pair], 1e-9)
        differ = []
        by_noise = []
        for log in (log for log in logs if log.count[0, j] > 0):
            H = log.H[0, j][np.ix_(pair, pair)]
            inverse = np.linalg.inv(H / noise[j] + np.diag(usual**-2.0))
            differ.append(inverse @ (log.g[0, j] - log.H[0, j] @ found.theta)[pair] / noise[j])
            by_noise.append(inverse @ H @ inverse / noise[j])
        if len(differ) < 2:
            continue
        scatter = np.transpose(differ) @ differ / (len(differ) - 1) - np.mean(by_noise, axis=0)
        values, vectors = np.linalg.eigh(scatter / np.outer(usual, usual))
        beyond = (vectors * np.maximum(values, 0.0)) @ vectors.T
        open_still[np.ix_(pair, pair)] = beyond * np.outer(usual, usual)
    return open_still
