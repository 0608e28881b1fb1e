"""Weights of samples: those that few others are like, as of a start from rest, count less."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.moments import Recording, predicted
from irb2400_ctrl.identification.fitting.noise import NOTHING
from irb2400_ctrl.model import Model

DEGREES_OF_FREEDOM = 4.0
"""of the Student-t on each sample"""
ROUNDS = 20
"""of its scale"""


def student_weighted(
    model: Model, layout: ColumnLayout, parts: Sequence[Recording], theta: Array
) -> list[Recording]:
    """The recordings with weights of a Student-t about what `theta` (p,) predicts, one on the mean
    of each joint: iteratively reweighted least squares, w = (nu + 1) / (nu + r^2 / s^2).

    Args:
        model: of the arm.
        layout: which columns there are.
        parts: the recordings.
        theta: fitted numbers, shape (p,).
    """
    left = [part.motion.tau - predicted(model, layout, part, theta) for part in parts]
    known = np.concatenate([part.motion.known for part in parts])
    squares = np.where(known, np.concatenate(left) ** 2, 0.0)
    count = np.maximum(known.sum(axis=0), 1)
    scale = np.maximum(squares.sum(axis=0) / count, NOTHING**2)
    nu = DEGREES_OF_FREEDOM
    for _ in range(ROUNDS):
        weight = (nu + 1.0) / (nu + squares / scale)
        scale = np.maximum((weight * squares).sum(axis=0) / count, NOTHING**2)
    weight *= count / np.maximum((weight * known).sum(axis=0), 1.0)
    ends = np.cumsum([len(part.motion.time) for part in parts])[:-1]
    shares = zip(parts, np.split(weight, ends), strict=True)
    return [replace(part, weight=own) for part, own in shares]
