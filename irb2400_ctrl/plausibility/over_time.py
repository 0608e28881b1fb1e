"""Whether a log agrees with itself: a stretch of it beside what the rest says, by joint.

    tau_j = tau_nominal_j + Y_j delta_j + Fc_j turn_j + Fv_j qd_j + J_j qdd_j + o_j + e_j

with numbers delta_j of its own for every joint, fitted to the record without the stretch. The
scatter of e_j in the stretch and outside of it are compared with one scatter everywhere:

    gain = N ln s^2 - N_in ln s_in^2 - N_out ln s_out^2,     N = N_in + N_out independent rows

twice the log likelihood ratio. A channel that sticks, turns its sign or its unit, a load that is
taken up, a contact look so; an effect that the model lacks is there all the time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, one_thread
from irb2400_ctrl.measurement.instants.time_base import ungrouped, with_time_base
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.plausibility.columns.jumps import MOVES
from irb2400_ctrl.plausibility.coupled_wrist import of_other_axes
from irb2400_ctrl.plausibility.evidence import Nominal
from irb2400_ctrl.plausibility.problem import named
from irb2400_ctrl.plausibility.rows import Rows, rows_of
from irb2400_ctrl.robot import Robot

PIECES = 24
"""of the record, at whose edges a stretch begins and ends"""
FEWEST = 4
"""rows of a piece"""
GAIN = 15.0
"""twice the log likelihood ratio from which a stretch is told of whose torque all is left; where
less is, more is asked in proportion (`benchmarks/corrupted_logs.py over-time` prints how near sound
logs come)"""
FLOOR = 0.01
"""of the joint's torque: what a simulation leaves is no scatter"""
OR_GEARS = (
    ", or gears of the wrist by which another axis turns that motor (`irb2400 identify` looks for "
    "them)"
)
"""added where such gears would explain the stretch as well"""
OWN = 0.1
"""misfit over the torque's size beside which a joint's numbers are fitted"""
RANK = 1e-6
"""singular value over the largest, below which columns are the same"""


@dataclass(frozen=True)
class Stretch:
    """A part of a record that does not go with the rest.

    Args:
        joint: whose torque, from 1.
        start, stop: of it [s].
        begins, ends: whether the record begins or ends with it.
        gain: twice the log likelihood ratio.
        share, rest: what is left of it and of the rest, over the joint's torque.
    """

    joint: int
    start: float
    stop: float
    begins: bool
    ends: bool
    gain: float
    share: float
    rest: float

    @property
    def when(self) -> str:
        """In words."""
        if self.begins:
            return f"up to {self.stop:.1f} s"
        if self.ends:
            return f"from {self.start:.1f} s on"
        return f"from {self.start:.1f} to {self.stop:.1f} s"

    @property
    def told(self) -> bool:
        """Whether it is no scatter of what no model knows."""
        return self.gain * self.share > GAIN

    def overlaps(self, other: Stretch) -> bool:
        """Whether both have an instant in common."""
        return self.start < other.stop and other.start < self.stop


def disagreement(nominal: Nominal, rows: Rows) -> str:
    """What the reader should know of a log, a stretch of which does not go with the rest; else
    nothing.
    """
    told = [found for found in stretches(nominal, rows) if found.told]
    if not told:
        return ""
    worst = max(told, key=lambda found: found.gain)
    joints = [found.joint for found in told if found.overlaps(worst)]
    beside_gears = {found.joint for found in stretches(nominal, rows, geared=True) if found.told}
    gears = "" if beside_gears.intersection(joints) else OR_GEARS
    return (
        f"{worst.when} the torque of {named(joints)} does not go with the rest of the log: what "
        f"leaves {100 * worst.rest:.0f} % of it elsewhere leaves {100 * worst.share:.0f} % "
        "there. A load taken up or put down, a contact, a channel that stuck or changed its unit, "
        f"sign or zero{gears}? Cut the log there unless you know"
    )


@one_thread()
def against_the_rest(robot: Robot, log: Log) -> str:
    """`disagreement` of a log as it was recorded; nothing where it is too short for one.

    Args:
        robot: to hold it against; log: of it.
    """
    rows = rows_of(with_time_base(ungrouped(log)))
    return "" if rows is None else disagreement(Nominal(robot), rows)


def stretches(nominal: Nominal, rows: Rows, geared: bool = False) -> list[Stretch]:
    """The stretch of each moving joint that goes least with the rest of its torque.

    Args:
        nominal: the robot as a yardstick; rows: of the log as labelled.
        geared: whether axes of the wrist may turn each other's motors: friction of one then has
            the sign of another's motion.
    """
    free = nominal.with_unknown_rotors()
    own = np.full(rows.tau.shape[1], OWN)
    X, y, weight = free.weighted(rows, free.columns(rows), own)
    if geared:
        X = np.concatenate([X, of_other_axes(rows) * weight[:, :, None]], axis=2)
    # at rest dry friction holds anything
    X[rows.still] = 0.0
    y[rows.still] = 0.0
    # rows that tell something of their own, by row and joint
    counts = (weight * own * rows.size * ~rows.still) ** 2
    edges = np.linspace(0, len(y), min(PIECES, len(y) // FEWEST) + 1).astype(np.intp)
    moving = np.flatnonzero((np.ptp(rows.q, axis=0) > MOVES) & ~rows.silent)
    return [
        _worst(int(j) + 1, rows.time, edges, _Sums.of(X[:, j], y[:, j], counts[:, j], edges))
        for j in moving
    ]


@dataclass(frozen=True)
class _Sums:
    """Sums of weighted rows over pieces of a record: X^T X (k, p, p), X^T y (k, p), y^T y (k,) and
    independent rows (k,)."""

    H: Array
    g: Array
    c: Array
    count: Array

    @classmethod
    def of(cls, X: Array, y: Array, count: Array, edges: Integers) -> _Sums:
        """Of one joint.

        Args:
            X, y: weighted slopes (m, p) and torques (m,); count: independent rows in each, (m,).
            edges: of the pieces.
        """
        U, sizes, _ = np.linalg.svd(X, full_matrices=False)
        X = (U * sizes)[:, sizes > RANK * sizes[0]]
        starts = edges[:-1]
        return cls(
            np.add.reduceat(X[:, :, None] * X[:, None, :], starts, axis=0),
            np.add.reduceat(X * y[:, None], starts, axis=0),
            np.add.reduceat(y**2, starts),
            np.add.reduceat(count, starts),
        )

    def over(self, first: Integers, last: Integers) -> _Sums:
        """The same over several pieces each, from `first` up to `last`."""
        parts = (np.concatenate([0 * s[:1], np.cumsum(s, axis=0)]) for s in self._all)
        return _Sums(*(part[last] - part[first] for part in parts))

    def without(self, some: _Sums) -> _Sums:
        """What is left of the whole record."""
        pairs = zip(self._all, some._all, strict=True)
        return _Sums(*(every.sum(axis=0) - part for every, part in pairs))

    def scatter(self, fitted: _Sums) -> Array:
        """Mean square of what the numbers leave that fit other rows best, (k,), in squares of the
        misfit."""
        numbers = np.linalg.solve(fitted.A, fitted.g[..., None])[..., 0]
        bent = np.einsum("...i,...ij,...j->...", numbers, self.H, numbers)
        left = self.c - 2.0 * np.einsum("...i,...i->...", self.g, numbers) + bent
        mean = np.maximum(left, 0.0) / np.maximum(self.count, 1e-12)
        return np.asarray(mean + (FLOOR / OWN) ** 2)

    @property
    def A(self) -> Array:
        """Normal equations beside the nominal numbers, which one standard deviation is known of."""
        return self.H + np.eye(self.H.shape[-1])

    @property
    def _all(self) -> tuple[Array, Array, Array, Array]:
        return self.H, self.g, self.c, self.count


def _worst(joint: int, time: Array, edges: Integers, sums: _Sums) -> Stretch:
    """The stretch of a joint with the largest gain.

    Args:
        joint: from 1; time: of the rows [s].
        edges: of the pieces, of which `sums` are.
    """
    k = len(edges) - 1
    first, last = (ends.astype(np.intp) for ends in np.triu_indices(k + 1, 1))
    short = last - first <= k // 2
    first = first[short]
    last = last[short]
    inside = sums.over(first, last)
    outside = sums.without(inside)
    whole = sums.over(0 * first, 0 * last + k)
    every = whole.scatter(whole)
    outer = outside.scatter(outside)
    inner = inside.scatter(outside)
    gain = (
        whole.count * np.log(every) - inside.count * np.log(inner) - outside.count * np.log(outer)
    )
    best = int(np.argmax(np.where(inside.count > 0, gain, -np.inf)))
    return Stretch(
        joint,
        float(time[edges[first[best]]]),
        float(time[edges[last[best]] - 1]),
        begins=bool(first[best] == 0),
        ends=bool(last[best] == k),
        gain=float(gain[best]),
        rest=float(OWN * np.sqrt(outer[best])),
        share=float(OWN * np.sqrt(inner[best])),
    )
