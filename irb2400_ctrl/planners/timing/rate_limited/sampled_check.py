"""Ratios of a motion to its limits where they have no bound: sampled, with room to spare."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import OutputRatios
from irb2400_ctrl.planners.timing.time_law import TimeLaw

# samples per second
_RATE = 10_000.0
_CHUNK = 50_000
# added to what the samples show, as a part of it
_ROOM = 0.01
SAMPLED_NOTE = (
    "the torque bound holds at every instant; the rate of a torque that depends on time, load or "
    "memory has no bound: "
    f"it was looked at {_RATE:,.0f} times a second and held back with {100 * _ROOM:.0f} % to spare"
)


def filled_by_samples(
    bounds: OutputRatios,
    law: TimeLaw,
    path: JointPath,
    limits: MotionLimits,
    dynamics: PathDynamics,
) -> OutputRatios:
    """The same with infinite bounds of torques and their rates replaced by what 10,000 samples per
    second show."""
    n = dynamics.n
    value = bounds.value.copy()
    rate = bounds.rate.copy()
    open_value = ~np.isfinite(value[:, :n])
    open_rate = ~np.isfinite(rate[:, :n])
    if not (open_value.any() or open_rate.any()):
        return bounds
    torque, change = _sampled(law, path, dynamics, bounds.s)
    sampled_value = (1 + _ROOM) * torque / limits.tau_max
    value[:, :n] = np.where(open_value, sampled_value, value[:, :n])
    if limits.torque_rate is not None:
        sampled_rate = (1 + _ROOM) * change / limits.torque_rate
        rate[:, :n] = np.where(open_rate, sampled_rate, rate[:, :n])
    return replace(bounds, value=value, rate=rate)


def _sampled(
    law: TimeLaw, path: JointPath, dynamics: PathDynamics, s: Array
) -> tuple[Array, Array]:
    """Largest |tau| and |dtau/dt|, dry friction apart from the second, in cells and their
    neighbours, each (m, n)."""
    count = int(np.ceil(law.duration * _RATE)) + 1
    dt = float(law.duration) / (count - 1)
    found = np.zeros((2, len(s) - 1, dynamics.n))
    for first in range(0, count - 1, _CHUNK):
        time = dt * np.arange(first, min(first + _CHUNK + 1, count), dtype=float)
        at, q, qd, qdd = law.motion(path, time)
        tau = dynamics.torque(q, qd, qdd, time)
        smooth = tau - FrictionLaw.of_table(dynamics.friction).dry(qd)
        # where a joint turns back, what depends on its direction jumps
        turned = np.sign(qd[1:]) != np.sign(qd[:-1])
        change = np.where(turned, 0.0, np.abs(np.diff(smooth, axis=0)) / dt)
        cell = np.clip(np.searchsorted(s, at) - 1, 0, len(s) - 2)
        np.maximum.at(found[0], cell, np.abs(tau))
        np.maximum.at(found[1], cell[1:], change)
    padded = np.pad(found, ((0, 0), (1, 1), (0, 0)))
    around = np.maximum(np.maximum(padded[:, :-2], padded[:, 1:-1]), padded[:, 2:])
    return around[0], around[1]
