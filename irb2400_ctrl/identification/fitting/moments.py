"""The logs as sums: what least squares needs of them, block by block, whatever their length.

For joint j and block b of time, with regressor rows a_i, torques y_i and weights w_i of the samples
that are known,

    H = sum w_i a_i a_i^T,    g = sum w_i a_i y_i,    c = sum w_i y_i^2,    N = sum 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, columns, torque_of
from irb2400_ctrl.measurement.motion.standstill import STICKING_SPEED
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model

BLOCKS = 120
"""about so many at most: the sums of an hour need no more memory than those of two minutes"""
CHUNK = 4000
"""samples whose regressor is held at a time"""


@dataclass(frozen=True)
class Moments:
    """Sums per block of time and joint; blocks b, joints n, columns p.

    Args:
        H: shape (b, n, p, p); g: (b, n, p); c: (b, n); count: samples, (b, n).
    """

    H: Array
    g: Array
    c: Array
    count: Array

    def taken(self, blocks: Integers) -> Moments:
        """Those of some blocks."""
        return Moments(self.H[blocks], self.g[blocks], self.c[blocks], self.count[blocks])

    def part(self, columns: Integers) -> Moments:
        """Those of some columns."""
        H = self.H[:, :, columns[:, None], columns]
        return Moments(H, self.g[:, :, columns], self.c, self.count)

    def summed(self) -> Moments:
        """All blocks as one."""
        return Moments(
            *(x.sum(axis=0, keepdims=True) for x in (self.H, self.g, self.c, self.count))
        )

    def less(self, other: Moments) -> Moments:
        """Without the samples of another, of as many blocks."""
        return Moments(
            self.H - other.H, self.g - other.g, self.c - other.c, self.count - other.count
        )

    def gathered(self, most: int) -> Moments:
        """Blocks that hold samples, in order, as `most` of about as many each."""
        full = np.flatnonzero(self.count.any(axis=1))
        groups = np.array_split(full, max(1, min(most, len(full))))
        return Moments(
            *(
                np.stack([x[group].sum(axis=0) for group in groups])
                for x in (self.H, self.g, self.c, self.count)
            )
        )

    def squared_error(self, theta: Array) -> Array:
        """Sum of squared residuals per block and joint, shape (b, n) [Nm2]."""
        quadratic = np.einsum("bnpq,p,q->bn", self.H, theta, theta, optimize=True)
        return np.asarray(np.maximum(quadratic - 2 * self.g @ theta + self.c, 0.0))


@dataclass(frozen=True)
class Recording:
    """A prepared log, what is known of its torque beforehand, and the block of each sample.

    Args:
        motion: on a uniform grid; block: number of each sample's block, (m,);
        given: torque of what the file has and the fit leaves alone, (m, n) [Nm].
        weight: of each sample and joint, (m, n); default one.
    """

    motion: PreparedLog
    block: Integers
    given: Array
    weight: Array | None = None


def recordings(motions: Sequence[PreparedLog]) -> list[Recording]:
    """The motions cut into blocks of a second, long ones into longer: about `BLOCKS` in all, as
    many of each log, since an hour of one kind of motion says little of the scatter of another."""
    found = []
    first = 0
    for motion in motions:
        duration = float(motion.time[-1] - motion.time[0])
        seconds = max(1.0, duration * len(motions) / BLOCKS)
        number = ((motion.time - motion.time[0]) / seconds).astype(np.int64)
        found.append(Recording(motion, first + number, np.zeros_like(motion.tau)))
        first += int(number[-1]) + 1
    return found


def faster_half(parts: Sequence[Recording]) -> list[Recording]:
    """The recordings as if each joint were known only at more than half of its fastest speed, the
    one that a hundredth of the samples of its motion exceed."""
    return _upper_half(parts, [np.abs(part.motion.qd) for part in parts])


def heavier_half(model: Model, layout: ColumnLayout, parts: Sequence[Recording]) -> list[Recording]:
    """The same of the torque that each gear carries (`ColumnLayout.pressing`).

    Args:
        model: of the arm; layout: whose bodies press; parts: the recordings.
    """
    bodies = np.array(layout.pressing)
    loads = []
    for part in parts:
        m = part.motion
        loads.append(np.abs(model.body_torque(m.q, m.qd, m.qdd, bodies)))
    return _upper_half(parts, loads)


def _upper_half(parts: Sequence[Recording], sizes: Sequence[Array]) -> list[Recording]:
    """As if known only where a size (m, n) is more than half of its largest in motion."""
    pairs = list(zip(parts, sizes, strict=True))
    moves = [p.motion.known & (np.abs(p.motion.qd) > STICKING_SPEED) for p in parts]
    every = np.concatenate([np.where(m, s, np.nan) for m, s in zip(moves, sizes, strict=True)])
    edge = [
        0.5 * np.quantile(own[~np.isnan(own)], 0.99) if (~np.isnan(own)).any() else np.inf
        for own in every.T
    ]
    return [
        replace(p, motion=replace(p.motion, known=p.motion.known & (size > edge)))
        for p, size in pairs
    ]


def moments(model: Model, layout: ColumnLayout, parts: Sequence[Recording]) -> Moments:
    """The sums of all recordings.

    Args:
        model: of the arm.
        layout: which columns there are.
        parts: the recordings.
    """
    blocks = 1 + max(int(part.block[-1]) for part in parts)
    n = model.robot.n
    p = layout.count
    H = np.zeros((blocks, n, p, p))
    g = np.zeros((blocks, n, p))
    c = np.zeros((blocks, n))
    count = np.zeros((blocks, n))
    for block, known, tau, weight, rows in _pieces(model, layout, parts):
        for j in range(n):
            held = rows[known[:, j], j]
            torque = tau[known[:, j], j]
            own = weight[known[:, j], j]
            scaled = held.T * own
            H[block, j] += scaled @ held
            g[block, j] += scaled @ torque
            c[block, j] += own @ torque**2
            count[block, j] += len(torque)
    return Moments(H, g, c, count)


def _pieces(
    model: Model, layout: ColumnLayout, parts: Sequence[Recording]
) -> Iterator[tuple[int, Mask, Array, Array, Array]]:
    """Block number, what is known, torques, weights and regressors, a block or a part of one at a
    time."""
    for part in parts:
        m = part.motion
        torque = m.tau - part.given
        weight = np.ones_like(torque) if part.weight is None else part.weight
        for first in range(0, len(m.time), CHUNK):
            chunk = slice(first, first + CHUNK)
            rows = _recorded_columns(model, layout, m, chunk)
            number = part.block[chunk]
            for block in np.unique(number):
                inside = number == block
                seen = (signal[chunk][inside] for signal in (m.known, torque, weight))
                yield int(block), *seen, rows[inside]


def _recorded_columns(model: Model, layout: ColumnLayout, m: PreparedLog, chunk: slice) -> Array:
    """The columns of some samples as the log shows them, shape (chunk, n, p)."""
    (recorder,) = m.recorders
    beside = 0 if recorder is None else recorder.half(m.step)
    start = max(chunk.start - beside, 0)
    wide = slice(start, chunk.stop + beside)
    rows = columns(model, layout, m.q[wide], m.qd[wide], m.qdd[wide])
    if recorder is None:
        return rows
    return recorder(rows, m.step)[chunk.start - start :][: chunk.stop - chunk.start]


def predicted(model: Model, layout: ColumnLayout, part: Recording, theta: Array) -> Array:
    """Torque along a recording, what is given included, shape (m, n) [Nm].

    Args:
        model: of the arm.
        layout: which columns there are.
        part: the recording.
        theta: their numbers, shape (p,).
    """
    motion = part.motion
    found = np.zeros_like(part.given)
    for first in range(0, len(motion.time), CHUNK):
        chunk = slice(first, first + CHUNK)
        states = (motion.q[chunk], motion.qd[chunk], motion.qdd[chunk])
        found[chunk] = torque_of(model, layout, theta, *states)
    return part.given + motion.as_recorded(found)
