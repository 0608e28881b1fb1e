"""`settled_reference`: a timed path slowed until what the controller receives keeps the limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.reference_bounds import ReferenceBounds
from irb2400_ctrl.planners.timing.sampled_reference.sampled_reference import SampledReference
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_law import TimeLaw

_ROUNDS = 20
# a ratio to a limit that slowing down is not tried on
_HOPELESS = 3.0
_ROUNDING = 1e-7
# parts of what was slowed that are tried
_FINER = 8
# samples per second of a torque that has no bound, and seconds that are sampled at once
_RATE = 1e4
_SPAN = 10.0


@dataclass(frozen=True)
class Settled:
    """A time law, the rows of its file, and what is sure of them over all times."""

    law: TimeLaw
    reference: SampledReference
    """with the digits of the file"""
    bounds: ReferenceBounds
    torque: Array
    """largest |tau| of each axis [Nm], shape (n,); of samples where there is no bound"""
    feed_ratio: float | None
    """speed of the TCP over the feed; None without a feed"""

    @property
    def bounded(self) -> bool:
        """Whether the torque has a bound."""
        return bool(np.isfinite(self.bounds.torque).all())

    def worst(self, limits: MotionLimits) -> float:
        """The largest part of a limit, feed included."""
        torque = float((self.torque / limits.tau_max).max())
        speed = self.bounds.velocity_ratio(limits.qd_max)
        return max(torque, speed, self.feed_ratio or 0.0)


def settled_reference(
    dynamics: PathDynamics,
    task: TaskPath,
    law: TimeLaw,
    limits: MotionLimits,
    sampling: Sampling,
    slow: bool,
) -> Settled:
    """The rows of a timed path, bounded; the law slowed first, where allowed, until they keep
    torque, speed and feed.

    What is slowed is small where the law was made for the rows (`Sampling.torque_ratios`).
    """
    found = _looked_at(dynamics, task, law, limits, sampling)
    factor = 1.0
    for _ in range(_ROUNDS if slow else 0):
        worst = found.worst(limits)
        if not 1 < worst < _HOPELESS:
            break
        factor *= 1 + 0.7 * (worst - 1) + _ROUNDING
        found = _looked_at(dynamics, task, law.slowed(factor), limits, sampling)
    if factor == 1.0 or found.worst(limits) > 1:
        return found
    # rows at other places of the motion swing differently: the least slowing that is enough
    for part in np.arange(1, _FINER) / _FINER:
        slower = law.slowed(1 + part * (factor - 1))
        other = _looked_at(dynamics, task, slower, limits, sampling)
        if other.worst(limits) <= 1:
            return other
    return found


def _looked_at(
    dynamics: PathDynamics, task: TaskPath, law: TimeLaw, limits: MotionLimits, sampling: Sampling
) -> Settled:
    reference = sampling.reference(law, task.joints).as_written()
    bounds = reference.bounds(dynamics, limits)
    torque = bounds.torque.max(axis=0)
    if not np.isfinite(torque).all():
        torque = _sampled_torque(dynamics, reference)
    return Settled(law, reference, bounds, torque, task.feed_ratio(law, reference.places))


def _sampled_torque(dynamics: PathDynamics, reference: SampledReference) -> Array:
    """Largest |tau| of each axis over 10,000 samples per second [Nm], shape (n,)."""
    end = reference.rows.time[-1]
    found = np.zeros(dynamics.model.robot.n)
    for first in np.arange(0.0, end, _SPAN):
        t = np.arange(first, min(first + _SPAN, end), 1 / _RATE)
        tau = dynamics.torque(*reference.states(t), t)
        found = np.maximum(found, np.abs(tau).max(axis=0))
    return found
