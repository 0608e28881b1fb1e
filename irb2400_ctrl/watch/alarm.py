"""`Alarm`: when what is left of a torque has grown, by a sum of log likelihood ratios (CUSUM).

The energy u of a block is the usual one, U, times a chi-square of d degrees of freedom over d;
after a change of the arm it is k = `GROWN` times larger. Each block adds the log of the ratio of
the two likelihoods,

    x = d/2 ((1 - 1/k) u/U - ln k),   S <- max(0, S + x),

and an alarm is given where S reaches h. Where blocks are as in the learned stretch, E[exp(x)] = 1,
and the mean number of blocks until a false alarm is at least exp(h) (Lorden 1971, Ann. Math.
Statist. 42, 1897). U and d come from the learned stretch itself; d from sums over several blocks
where those scatter more than single blocks would, because neighbours are alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.watch.baseline import BLOCK, Blocks

GROWN = 4.0
"""times the usual energy that an alarm looks for: twice the residual"""
MONTH = 30 * 86400.0
"""[s] of motion between two false alarms, all joints together"""
LEAST_BLOCKS = 15
"""blocks of a joint that its usual energy is learned from"""
SUMS = (1, 2, 4, 8)
"""blocks that are summed to see whether neighbours are alike"""
SURE = 2.0
"""standard errors that the usual energy is taken larger by: it is learned from few blocks"""
ONE_BLOCK = 0.5
"""of the threshold that one block may add at most: one is never an alarm"""


@dataclass(frozen=True)
class Usual:
    """The usual energy of each joint and its degrees of freedom, shapes (n,); NaN where the learned
    stretch does not show a joint."""

    energy: Array
    degrees: Array

    @classmethod
    def of(cls, learned: Blocks) -> Usual:
        """As the learned blocks show it.

        Raises:
            InputError: no joint moves enough.
        """
        found = [_usual(column[np.isfinite(column)]) for column in learned.energy.T]
        energy, degrees = np.array(found).T
        if not np.isfinite(energy).any():
            raise InputError(
                f"found no joint that moves through {LEAST_BLOCKS} s of the learned stretch, "
                "expected motion: learn from a longer one (--learn SECONDS)"
            )
        return cls(energy, degrees)

    def ratio(self, energy: Array) -> Array:
        """Log likelihood ratio of blocks (b, n) or one (n,); zero where nothing is known."""
        k = GROWN
        x = self.degrees / 2 * ((1 - 1 / k) * energy / self.energy - np.log(k))
        return np.asarray(np.nan_to_num(x, nan=0.0))


def _usual(seen: Array) -> tuple[float, float]:
    """Energy and degrees of freedom of one joint."""
    if len(seen) < LEAST_BLOCKS:
        return np.nan, np.nan
    mean = float(seen.mean())
    spread = []
    for count in SUMS:
        sums = seen[: len(seen) // count * count].reshape(-1, count).mean(axis=1)
        spread.append(count * float(np.mean((sums - mean) ** 2)))
    degrees = 2 * mean**2 / max(spread)
    return mean * (1 + SURE * float(np.sqrt(2 / (degrees * len(seen))))), degrees


@dataclass(frozen=True)
class Alarm:
    """One joint left what is usual.

    Args:
        joint: counted from 1.
        since: when the sum began to rise: about when it happened [s].
        at: when the threshold was reached [s].
        torque: mean of what is left since then [Nm].
    """

    joint: int
    since: float
    at: float
    torque: float

    def to_json(self) -> dict[str, Any]:
        """For watch.json."""
        return {
            "joint": self.joint,
            "since_s": self.since,
            "at_s": self.at,
            "torque_Nm": self.torque,
        }


class Cusum:
    """The sums of all joints, block after block.

    Args:
        usual: of the learned stretch.
        between: mean time between false alarms of all joints together [s of motion].
    """

    def __init__(self, usual: Usual, between: float = MONTH) -> None:
        n = len(usual.energy)
        self.usual = usual
        self.threshold = float(np.log(n * between / BLOCK))
        self.sums = np.zeros(n)
        self._since = np.full(n, np.nan)
        self._torque = np.zeros(n)
        self._count = np.zeros(n)
        self._told = np.zeros(n, dtype=bool)

    def add(self, time: float, energy: Array, torque: Array) -> list[Alarm]:
        """One block; the alarms it gives. A joint alarms once until its sum is back at zero.

        Args:
            time: middle of the block [s].
            energy, torque: of the block, shape (n,); NaN where nothing is known.
        """
        x = np.minimum(self.usual.ratio(energy), ONE_BLOCK * self.threshold)
        begun = (self.sums == 0.0) & (x > 0.0)
        self._since[begun] = time - BLOCK / 2
        self._torque[begun] = 0.0
        self._count[begun] = 0.0
        self.sums = np.clip(self.sums + x, 0.0, 2 * self.threshold)
        known = np.isfinite(torque)
        self._torque[known] += torque[known]
        self._count[known] += 1.0
        self._told &= self.sums > 0.0
        new = (self.sums >= self.threshold) & ~self._told
        self._told |= new
        return [
            Alarm(
                int(j) + 1,
                float(self._since[j]),
                time + BLOCK / 2,
                float(self._torque[j] / self._count[j]),
            )
            for j in np.flatnonzero(new)
        ]
