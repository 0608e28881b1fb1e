"""`Sampling`: how a motion will be written and read, for solvers that have to keep limits so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.interpolation import Interpolation
from irb2400_ctrl.planners.timing.sampled_reference.sampled_reference import SampledReference
from irb2400_ctrl.planners.timing.time_law import TimeLaw

FeedRatios = Callable[[TimeLaw, JointPath], "tuple[Array, Array] | None"]
"""speed of the TCP over the feed, see `feed.feed_ratios`"""

# change of a torque from row to row, and per second at most, as parts of its limit: what a cubic
# between rows swings above it is about a seventh of the first
_PER_ROW = 0.2
_PER_SECOND = 50.0
PHASES = 4
"""beginnings of the rows that are looked at"""


@dataclass(frozen=True)
class Sampling:
    """Rows per second, and what is read between them."""

    rate: float
    """[1/s]"""
    interpolation: Interpolation

    @property
    def torque_rate(self) -> float:
        """Change of a torque, as a part of its limit [1/s], that rows so far apart can follow."""
        return min(_PER_ROW * self.rate, _PER_SECOND)

    def reference(self, law: TimeLaw, path: JointPath, before: float = 0.0) -> SampledReference:
        """The rows of a timed path, the first one `before` its start [s].

        Args:
            law: when the path is where.
            path: the joints over the length s [m].
            before: [s].
        """
        return SampledReference.of(law, path, self.rate, self.interpolation, before)

    def ratios(
        self,
        law: TimeLaw,
        path: JointPath,
        limits: MotionLimits,
        dynamics: PathDynamics,
        s: Array,
        feed_ratios: FeedRatios | None,
    ) -> tuple[Array, Array, Array]:
        """Largest |tau| / tau_max, |qdd| / qdd_max, and speed of an axis or of the TCP over its
        limit, while the reference passes each cell between the lengths s, shapes (m, n) twice and
        (m, 1).

        A motion that is changed a little has its rows elsewhere: the largest over rows that begin
        at several times is what does not depend on that.

        Args:
            law: when the path is where.
            path: the joints over the length s [m].
            limits: of torque [Nm], speed and acceleration, and of their rates.
            dynamics: the arm's torque along the path.
            s: ends of the cells [m], shape (m + 1,).
            feed_ratios: of the TCP's speed over the programmed feed; None where none is.
        """
        n = path.n
        found = np.zeros((len(s) - 1, 2 * n + 1))
        for part in range(PHASES):
            reference = self.reference(law, path, part / PHASES / self.rate)
            bounds = reference.bounds(dynamics, limits)
            rows = reference.rows.time
            ratio = np.zeros((len(rows) - 1, 2 * n + 1))
            torque = bounds.torque / limits.tau_max
            bend = bounds.acceleration / limits.qdd_max
            speed = (bounds.speed / limits.qd_max).max(axis=1, keepdims=True)
            parts = [(bounds.time, np.hstack([torque, bend, speed]))]
            feed = None if feed_ratios is None else feed_ratios(law, reference.places)
            if feed is not None:
                nothing = np.zeros((len(feed[1]), 2 * n))
                parts.append((feed[0], np.hstack([nothing, feed[1][:, None]])))
            for time, value in parts:
                interval = np.searchsorted(rows, (time[:-1] + time[1:]) / 2) - 1
                np.maximum.at(ratio, np.clip(interval, 0, len(ratio) - 1), value)
            found = np.maximum(found, _on_cells(s, law.at(rows)[0], ratio))
        return found[:, :n], found[:, n:-1], found[:, -1:]


def _on_cells(s: Array, ends: Array, values: Array) -> Array:
    """The largest of the values between `ends` (k + 1,) that overlap each cell of s, shape
    (m, n)."""
    both = np.unique(np.concatenate([s, ends]))
    middle = (both[:-1] + both[1:]) / 2
    cell = np.clip(np.searchsorted(s, middle) - 1, 0, len(s) - 2)
    origin = np.clip(np.searchsorted(ends, middle) - 1, 0, len(values) - 1)
    found = np.zeros((len(s) - 1, values.shape[1]))
    np.maximum.at(found, cell, values[origin])
    return found
