"""Joints whose error is that of a few samples: a torque at its limit, a contact, a torn row."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irb2400_ctrl.diagnosis.preparation.metrics import errors

if TYPE_CHECKING:
    from irb2400_ctrl.identification.identification import LogResult
    from irb2400_ctrl.identification.validation import LogComparison

FEW = 0.005
"""share of the samples; of normal noise these make a twentieth of the squared error"""
MOST = 0.5
"""of the squared error, from which they are said to make it"""
LEAST = 200
"""samples of a joint of which a few can be told"""


def few_samples(log: LogResult | LogComparison) -> list[str]:
    """A sentence for each joint where half of what is left, squared, stands in 0.5 % of the
    samples: how much, when, and what is left of the others. An RMSE says nothing of the joint
    then."""
    said = []
    left = np.where(log.known, log.measured - log.modelled, 0.0)
    for j in range(left.shape[1]):
        count = int(log.known[:, j].sum())
        if count < LEAST:
            continue
        square = left[:, j] ** 2
        worst = np.argsort(square)[-max(1, round(FEW * count)) :]
        share = square[worst].sum() / max(square.sum(), np.finfo(float).tiny)
        if share < MOST:
            continue
        others = log.known.copy()
        others[worst, j] = False
        rest = errors(log.measured, log.modelled, others).rmse_over_mean_percent[j]
        at = log.time[worst[-1]] - log.time[0]
        said.append(
            f"joint {j + 1}: {len(worst)} of {count:,} samples make {100 * share:.0f} % of the "
            f"squared error, the largest at {at:.2f} s; without them it leaves {rest:.1f} %"
        )
    return said
