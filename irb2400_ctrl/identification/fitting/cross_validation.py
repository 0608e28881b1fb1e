"""Which of two descriptions leaves less on stretches of the logs that it has not seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.estimate import Estimate, FitProblem

FOLDS = 5


def unseen_rms(problem: FitProblem, like: Estimate, *, bounded: bool = False) -> Array:
    """Rms torque that is left on held-out stretches, per stretch and joint, shape (FOLDS, n) [Nm].

    The blocks of time are cut into consecutive stretches; each is predicted from the others, with
    the weights of the joints and the widths of the bodies of a fit to all.

    Args:
        problem: of all recordings, block by block.
        like: a fit of the same arm: its noise and widths.
        bounded: whether numbers that cannot be negative are not, and bodies are possible ones.
    """
    stretches = problem.sums.gathered(FOLDS)
    every = np.arange(len(stretches.H))
    found = []
    for held in every:
        seen = replace(problem, sums=stretches.taken(np.setdiff1d(every, held)).summed())
        if bounded:
            theta = seen.estimate(kappa=like.kappa, sigma=like.sigma, rounds=1).theta
        else:
            theta = seen.unbounded_minimum(like)
        part = stretches.taken(np.array([held]))
        count = np.maximum(part.count.sum(axis=0), 1.0)
        found.append(np.sqrt(part.squared_error(theta).sum(axis=0) / count))
    return np.array(found)
