"""The slow part of a log, a few rows per second: enough to tell what its columns are."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.ndimage import convolve1d
from scipy.signal import firwin

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.uniform import resample
from irb2400_ctrl.plausibility.reading import Reading

CUTOFF = 4.0
"""[Hz] of the filter on motion and torque"""
MOST = 200
"""rows at most"""
LEAST = 20
"""rows at least"""
SHORTEST = 2.5
"""[s] of motion that a comparison with a model needs"""
CREEP = 0.01
"""[rad/s] below this the direction of dry friction is not known, and"""
SLOW = 0.05
"""of the joint's rms speed"""
UNMOVED = 1e-9
"""[rad] of travel of an angle that never changes"""
SMALLEST = 1e-5
"""of the arm's largest torque, below which a joint's is as good as none"""


@dataclass(frozen=True)
class Rows:
    """Motion and torque of a log through one low-pass, decimated; shapes (m, n), SI.

    `turn` is the filtered direction of motion: what dry friction follows; `still` says where it is
    not known; `time` is the log's, shape (m,) [s], `seconds` what of it was recorded.
    """

    q: Array
    qd: Array
    qdd: Array
    turn: Array
    still: Mask
    tau: Array
    seconds: float
    time: Array

    @cached_property
    def size(self) -> Array:
        """Rms torque of each joint, shape (n,) [Nm]; never zero."""
        size = np.sqrt(np.mean(self.tau**2, axis=0))
        return np.asarray(size + SMALLEST * size.max() + 1e-9)

    @cached_property
    def silent(self) -> Mask:
        """Joints of which nothing was recorded, or that a brake holds: they tell nothing, (n,)."""
        return np.asarray((np.ptp(self.q, axis=0) < UNMOVED) & ~self.tau.any(axis=0))

    def thinned(self, keep: int) -> Rows:
        """Every `keep`-th row of as many seconds."""
        if keep == 1 or len(self.q) < LEAST * keep:
            return self
        q, qd, qdd, turn, tau = (
            part[::keep] for part in (self.q, self.qd, self.qdd, self.turn, self.tau)
        )
        return Rows(q, qd, qdd, turn, self.still[::keep], tau, self.seconds, self.time[::keep])

    def with_torque(self, tau: Array) -> Rows:
        """The same motion with other torques."""
        return replace(self, tau=tau)

    def read_as(self, reading: Reading) -> Rows:
        """The rows another reading of the columns gives (its delay apart)."""
        B = reading.angles
        clock = reading.clock
        # the direction of motion depends neither on a clock nor on a unit: a sharper friction alone
        # would make a joint that creeps move faster
        one_column = np.count_nonzero(B, axis=1) == 1
        turn = np.where(one_column, self.turn @ np.sign(B).T, np.tanh(self.qd @ B.T / CREEP))
        return Rows(
            self.q @ B.T + reading.offset,
            self.qd @ B.T / clock,
            self.qdd @ B.T / clock**2,
            turn,
            # what is still stays still, or slow motion would be cheap to explain
            self.still[:, np.argmax(np.abs(B), axis=1)],
            self.tau @ reading.torques.T,
            self.seconds,
            self.time,
        )


@dataclass(frozen=True)
class Slow:
    """A log through the low-pass, on an even grid of `step` [s]; shapes (m, n), SI.

    `gap` says where something is missing, shape (m,); outputs nearer than `half` samples to an end
    are not complete.
    """

    angles: Array
    qd: Array
    qdd: Array
    turn: Array
    tau: Array
    time: Array
    gap: Mask
    half: int
    step: float
    cutoff: float

    @classmethod
    def of(cls, log: Log) -> Slow | None:
        """None where too little of a log is left to compare."""
        if len(log.time) < LEAST or log.duration < SHORTEST:
            return None
        even = resample(log)
        step = even.step
        cutoff = min(CUTOFF, 0.3 * log.rate)
        half = int(np.ceil(0.8 / (cutoff * step)))
        weights = firwin(2 * half + 1, cutoff, fs=1.0 / step)

        def slow(signal: Array) -> Array:
            return np.asarray(convolve1d(signal, weights, axis=0, mode="nearest"))

        angles = slow(even.q)
        qd = np.gradient(angles, step, axis=0)
        qdd = np.gradient(qd, step, axis=0)
        turn = slow(np.tanh(qd / CREEP))
        gap = np.convolve(~even.valid, np.ones(2 * half + 1), mode="same") > 0.5
        return cls(angles, qd, qdd, turn, slow(even.tau), even.time, gap, half, step, cutoff)

    def rows(self, delay: float = 0.0) -> Rows | None:
        """Rows of it; None where too little of it is left to compare.

        Args:
            delay: torques are recorded so much later than the motion they belong to [s].
        """
        half = self.half
        late = round(delay / self.step)
        place = np.arange(half + 2, len(self.angles) - half - 2)
        place = place[(place + late >= half) & (place + late < len(self.angles) - half)]
        place = place[~self.gap[place]]
        seconds = len(place) * self.step
        every = max(1, int(0.1 / (self.cutoff * self.step)), int(np.ceil(len(place) / MOST)))
        place = place[::every]
        if len(place) < LEAST:
            return None
        q, qd, qdd, turn = (signal[place] for signal in (self.angles, self.qd, self.qdd, self.turn))
        still = (np.abs(qd) < self._slowest) | (np.abs(turn) < 0.5)
        return Rows(q, qd, qdd, turn, still, self.tau[place + late], seconds, self.time[place])

    @cached_property
    def _slowest(self) -> Array:
        """Speed of each joint below which it stands still, shape (n,) [rad/s]."""
        return np.asarray(np.maximum(CREEP, SLOW * np.sqrt(np.mean(self.qd**2, axis=0))))


def rows_of(log: Log) -> Rows | None:
    """Rows of a log; None where too little of it is left to compare."""
    slow = Slow.of(log)
    return None if slow is None else slow.rows()
