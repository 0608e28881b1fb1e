"""What a fit leaves on recordings, or parts of them, that it has not seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.diagnosis.estimation.reversals import near_reversals
from irb2400_ctrl.identification.fitting.baseline import plain_least_squares
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.estimate import FitProblem
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Recording, predicted
from irb2400_ctrl.identification.identification import LogResult
from irb2400_ctrl.model import Model

MOST_FOLDS = 5
MEAN_OVER = 0.2
"""[s]"""
FEWEST_MEANS = 10
"""of a log whose own error counts"""


def groups(parts: Sequence[Recording], slow: Sequence[bool]) -> list[Integers]:
    """Blocks that are held out together: logs, at most `MOST_FOLDS` groups of them, or the halves
    of a single log. Logs of slow runs, which tell nothing of bodies, are a group of their own."""
    own = [np.unique(part.block) for part in parts]
    moving = [blocks for blocks, runs in zip(own, slow, strict=True) if not runs]
    still = [blocks for blocks, runs in zip(own, slow, strict=True) if runs]
    found = [np.concatenate(still)] if still and moving else []
    moving = moving or still
    if len(moving) == 1:
        return [*np.array_split(moving[0], 2), *found]
    shares = np.array_split(np.arange(len(moving)), min(MOST_FOLDS, len(moving)))
    return [*(np.concatenate([moving[k] for k in share]) for share in shares), *found]


def held_out(
    model: Model, found: Fit, parts: Sequence[Recording], slow: Sequence[bool]
) -> tuple[list[Array], list[Array]]:
    """(predictions of fits that had not seen the sample, the same by plain least squares), (m, n)
    for each recording [Nm].

    Args:
        slow: which recordings are of slow runs at constant speed.
    """
    ours = [np.zeros_like(part.motion.tau) for part in parts]
    plain = [np.zeros_like(part.motion.tau) for part in parts]
    bare = ColumnLayout(found.layout.n)
    bare_sums = found.sums.part(bare.within(found.layout))
    every = np.arange(len(found.sums.H))
    positive = found.layout.positive()
    for held in groups(parts, slow):
        seen = np.setdiff1d(every, held)
        rest = found.weighted.taken(seen)
        problem = FitProblem(rest, found.prior, found.correlation, positive)
        alike = found.numbers.usual > 1.0
        again = problem.averaged(problem.estimate(start=found.numbers, alike=alike))
        shortest = plain_least_squares(bare_sums.taken(seen))
        for place, part in enumerate(parts):
            inside = np.isin(part.block, held)
            if not inside.any():
                continue
            ours[place][inside] = predicted(model, found.layout, part, again.theta)[inside]
            plain[place][inside] = predicted(model, bare, part, shortest)[inside]
    return ours, plain


def slowly_left(results: Sequence[LogResult]) -> Array:
    """What the fit left of the log that is worst on each joint on stretches that it had not seen,
    noise apart: rms of its means over `MEAN_OVER`, shape (n,) [Nm].

    What one motion leaves another may leave: the mean over all is less than some of them. Where a
    joint turns it sticks first, which a diagnosis knows of every joint.
    """
    each = [_slowly_left(result) for result in results]
    squares = np.array([found for found, _ in each])
    counts = np.array([count for _, count in each])
    # a log with hardly any known rows is worst by chance; of nothing but these all count together
    long = counts >= FEWEST_MEANS
    worst = np.where(long, squares / np.maximum(counts, 1), 0.0).max(axis=0)
    together = squares.sum(axis=0) / np.maximum(counts.sum(axis=0), 1)
    return np.asarray(np.sqrt(np.where(long.any(axis=0), worst, together)))


def _slowly_left(result: LogResult) -> tuple[Array, Array]:
    """Sum of squares of one log's means, and how many there are, per joint, shapes (n,)."""
    n = result.measured.shape[1]
    step = float(result.time[1] - result.time[0])
    count = max(2, round(MEAN_OVER / step))
    whole = len(result.time) // count * count
    left = (result.measured - result.unseen)[:whole].reshape(-1, count, n)
    calm = result.known & ~near_reversals(result.qd, step)
    known = calm[:whole].reshape(-1, count, n).all(axis=1)
    means = np.sum(np.where(known, left.mean(axis=1), 0.0) ** 2, axis=0)
    steps = np.sum(np.where(known, np.mean(np.diff(left, axis=1) ** 2, axis=1), 0.0), axis=0)
    # of white noise a mean keeps one part in `count`, a step twice
    return np.maximum(means - 0.5 * steps / count, 0.0), known.sum(axis=0)
