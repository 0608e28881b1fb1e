"""Which of two descriptions leaves less on stretches of the logs that it has not seen."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.identification.fitting.estimate import Estimate, estimate, unbounded_minimum
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.prior import Prior

FOLDS = 5


def unseen_rms(
    sums: Moments, prior: Prior, like: Estimate, correlation: Array, positive: Mask | None = None
) -> Array:
    """Rms torque that is left on held-out stretches, per stretch and joint, shape (FOLDS, n) [Nm].

    The blocks of time are cut into consecutive stretches; each is predicted from the others, with
    the weights of the joints and the widths of the bodies of a fit to all.

    Args:
        sums: of all recordings, block by block.
        prior: of the robot file.
        correlation: samples per independent one, of each joint, shape (n,) [-].
        like: a fit of the same arm: its noise and widths.
        positive: columns whose numbers cannot be negative, where bodies must be possible ones too,
            mask (p,); default no bounds.
    """
    stretches = sums.gathered(FOLDS)
    every = np.arange(len(stretches.H))
    found = []
    for held in every:
        seen = stretches.taken(np.setdiff1d(every, held)).summed()
        if positive is None:
            theta = unbounded_minimum(seen, prior, like, correlation)
        else:
            theta = estimate(
                seen,
                prior,
                correlation=correlation,
                positive=positive,
                kappa=like.kappa,
                sigma=like.sigma,
                rounds=1,
            ).theta
        part = stretches.taken(np.array([held]))
        count = np.maximum(part.count.sum(axis=0), 1.0)
        found.append(np.sqrt(part.squared_error(theta).sum(axis=0) / count))
    return np.array(found)
