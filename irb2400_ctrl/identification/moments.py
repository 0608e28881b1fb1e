"""The logs as sums: what least squares needs of them, block by block, whatever their length.

For joint j and block b of time, with regressor rows a_i and torques y_i,

    H = sum w_i a_i a_i^T,    g = sum w_i a_i y_i,    c = sum w_i y_i^2,    N = sum w_i.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.columns import ColumnLayout, columns
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model

CHUNK = 4000
"""samples whose regressor is held at a time"""


@dataclass(frozen=True)
class Moments:
    """Sums per block of time and joint; blocks b, joints n, columns p.

    Args:
        H: shape (b, n, p, p); g: (b, n, p); c: (b, n); count: sum of weights, (b, n).
    """

    H: Array
    g: Array
    c: Array
    count: Array

    def taken(self, blocks: Array) -> Moments:
        """Those of some blocks."""
        return Moments(self.H[blocks], self.g[blocks], self.c[blocks], self.count[blocks])

    def squared_error(self, theta: Array) -> Array:
        """Sum of weighted squared residuals per block and joint, shape (b, n) [Nm2]."""
        quadratic = np.einsum("bnpq,p,q->bn", self.H, theta, theta, optimize=True)
        return np.maximum(quadratic - 2 * self.g @ theta + self.c, 0.0)


@dataclass(frozen=True)
class Recording:
    """A prepared log with the weight of every torque, and the block that each sample is in.

    Args:
        motion: on a uniform grid; weight: (m, n), zero where the torque is not determined;
        block: number of each sample's block, (m,).
    """

    motion: PreparedLog
    weight: Array
    block: Array


def recordings(motions: Sequence[PreparedLog], seconds: float = 1.0) -> list[Recording]:
    """The motions cut into blocks of time; the first weight is whether the torque is known."""
    found = []
    first = 0
    for motion in motions:
        number = ((motion.time - motion.time[0]) / seconds).astype(int)
        found.append(Recording(motion, motion.known.astype(float), first + number))
        first += int(number[-1]) + 1
    return found


def moments(model: Model, layout: ColumnLayout, parts: Sequence[Recording]) -> Moments:
    """The sums of all recordings."""
    blocks = 1 + max(int(part.block[-1]) for part in parts)
    n = model.robot.n
    p = layout.count
    H = np.zeros((blocks, n, p, p))
    g = np.zeros((blocks, n, p))
    c = np.zeros((blocks, n))
    count = np.zeros((blocks, n))
    for block, weight, tau, rows in _pieces(model, layout, parts):
        for j in range(n):
            weighed = rows[:, j] * weight[:, j, None]
            H[block, j] += weighed.T @ rows[:, j]
            g[block, j] += weighed.T @ tau[:, j]
            c[block, j] += weight[:, j] @ tau[:, j] ** 2
            count[block, j] += weight[:, j].sum()
    return Moments(H, g, c, count)


def _pieces(
    model: Model, layout: ColumnLayout, parts: Sequence[Recording]
) -> Iterator[tuple[int, Array, Array, Array]]:
    """Block number, weights, torques and regressors, a block or a part of one at a time."""
    for part in parts:
        m = part.motion
        for first in range(0, len(m.time), CHUNK):
            chunk = slice(first, first + CHUNK)
            rows = columns(model, layout, m.q[chunk], m.qd[chunk], m.qdd[chunk])
            number = part.block[chunk]
            for block in np.unique(number):
                inside = number == block
                yield int(block), part.weight[chunk][inside], m.tau[chunk][inside], rows[inside]


def predicted(model: Model, layout: ColumnLayout, motion: PreparedLog, theta: Array) -> Array:
    """Torque along a motion, shape (m, n) [Nm]."""
    found = np.empty_like(motion.tau)
    for first in range(0, len(motion.time), CHUNK):
        chunk = slice(first, first + CHUNK)
        rows = columns(model, layout, motion.q[chunk], motion.qd[chunk], motion.qdd[chunk])
        found[chunk] = rows @ theta
    return found
