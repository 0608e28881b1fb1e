"""What a fit leaves on recordings, or parts of them, that it has not seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.diagnosis.preparation.metrics import Errors, errors
from irb2400_ctrl.identification.baseline import plain_least_squares
from irb2400_ctrl.identification.columns import ColumnLayout
from irb2400_ctrl.identification.estimate import estimate
from irb2400_ctrl.identification.fit import Fit
from irb2400_ctrl.identification.moments import Recording, predicted
from irb2400_ctrl.model import Model

MOST_FOLDS = 5


def groups(parts: Sequence[Recording]) -> list[Integers]:
    """Blocks that are held out together: logs, at most `MOST_FOLDS` groups of them, or the halves
    of a single log."""
    if len(parts) == 1:
        return list(np.array_split(np.unique(parts[0].block), 2))
    shares = np.array_split(np.arange(len(parts)), min(MOST_FOLDS, len(parts)))
    return [np.concatenate([np.unique(parts[place].block) for place in share]) for share in shares]


def held_out(
    model: Model, found: Fit, parts: Sequence[Recording]
) -> tuple[list[Array], list[Array]]:
    """(predictions of fits that had not seen the sample, the same by plain least squares), (m, n)
    for each recording [Nm]."""
    ours = [np.zeros_like(part.motion.tau) for part in parts]
    plain = [np.zeros_like(part.motion.tau) for part in parts]
    bare = ColumnLayout(found.layout.n)
    bare_sums = found.sums.part(bare.within(found.layout))
    every = np.arange(len(found.sums.H))
    for held in groups(parts):
        seen = np.setdiff1d(every, held)
        again = estimate(
            found.sums.taken(seen),
            found.prior,
            correlation=found.correlation,
            positive=found.layout.positive(),
            start=found.numbers,
        )
        shortest = plain_least_squares(bare_sums.taken(seen))
        for place, part in enumerate(parts):
            inside = np.isin(part.block, held)
            if not inside.any():
                continue
            ours[place][inside] = predicted(model, found.layout, part, again.theta)[inside]
            plain[place][inside] = predicted(model, bare, part, shortest)[inside]
    return ours, plain


def errors_of(part: Recording, prediction: Array) -> Errors:
    """Eqs. 75-77 where the torque is known."""
    return errors(part.motion.tau, prediction, part.motion.known)
