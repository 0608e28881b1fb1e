"""Ratios of a motion to its limits where they have no bound: looked at, with room to spare."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import cell_ratios

Array = npt.NDArray[np.float64]

# looks per second
_RATE = 10_000.0
_CHUNK = 50_000
# added to what was seen, as a part of it
_ROOM = 0.01
SAMPLED_NOTE = (
    "the torque bound holds at every instant; the rate of a torque that depends on time, load or "
    "memory has no bound: "
    f"it was looked at {_RATE:,.0f} times a second and held back with {100 * _ROOM:.0f} % to spare"
)


def sampled_ratios(
    certificate: Certificate, dynamics: PathDynamics, parts: int
) -> tuple[tuple[Array, Array, Array], Array]:
    """`cell_ratios`, with infinite bounds of torques and their rates replaced by what 10,000 looks
    per second show."""
    (value, rate, speed), s = cell_ratios(certificate, dynamics, parts)
    n = dynamics.model.robot.n
    open_value = ~np.isfinite(value[:, :n])
    open_rate = ~np.isfinite(rate[:, :n])
    if open_value.any() or open_rate.any():
        torque, change = _seen(certificate, dynamics, s)
        limits = certificate.limits
        value[:, :n] = np.where(open_value, (1 + _ROOM) * torque / limits.tau_max, value[:, :n])
        if limits.torque_rate is not None:
            rate[:, :n] = np.where(
                open_rate, (1 + _ROOM) * change / limits.torque_rate, rate[:, :n]
            )
    return (value, rate, speed), s


def _seen(certificate: Certificate, dynamics: PathDynamics, s: Array) -> tuple[Array, Array]:
    """Largest |tau| and |dtau/dt|, dry friction apart from the second, in cells and their
    neighbours, each (m, n)."""
    law = certificate.law
    model = dynamics.model
    count = int(np.ceil(law.duration * _RATE)) + 1
    dt = float(law.duration) / (count - 1)
    found = np.zeros((2, len(s) - 1, model.robot.n))
    for first in range(0, count - 1, _CHUNK):
        time = dt * np.arange(first, min(first + _CHUNK + 1, count), dtype=float)
        at, q, qd, qdd = law.motion(certificate.path, time)
        tau = dynamics.torque(q, qd, qdd, time)
        smooth = tau - FrictionLaw.of(model.robot).dry(qd)
        # where a joint turns back, what depends on its direction jumps
        turned = np.sign(qd[1:]) != np.sign(qd[:-1])
        change = np.where(turned, 0.0, np.abs(np.diff(smooth, axis=0)) / dt)
        cell = np.clip(np.searchsorted(s, at) - 1, 0, len(s) - 2)
        np.maximum.at(found[0], cell, np.abs(tau))
        np.maximum.at(found[1], cell[1:], change)
    padded = np.pad(found, ((0, 0), (1, 1), (0, 0)))
    around = np.maximum(np.maximum(padded[:, :-2], padded[:, 1:-1]), padded[:, 2:])
    return around[0], around[1]
