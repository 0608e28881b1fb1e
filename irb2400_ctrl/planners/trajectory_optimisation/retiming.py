"""Timing again where the fastest timing would spoil what was asked for: a limited torque rate, or
energy.

With a limited torque rate the geometry goes to `time_rate_limited`, whose bound holds at every
instant. Its path must leave its ends with q' other than zero, which a spline over time does not:
there the torque begins to change, q ~ t^3, so that the parameter grows with t^3 as well, up to
`_RAMP` intervals, and with t from there on.

For energy the time law is the solver's own, slowed by one factor.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure.cells import grid
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.trajectory_optimisation.knots import Knots
from irb2400_ctrl.planners.trajectory_optimisation.optimised import MotionOutcome, outcome
from irb2400_ctrl.planners.trajectory_optimisation.warm_start import clamped

# where the parameter of a smooth path grows with t^3, in intervals
_RAMP = 1.0
# cells of the smooth timing: half as many cost another half per cent
_COUNT = 1000
# samples within each interval, and the step of the difference there [s]
_SAMPLES = 6
_STEP = 1e-6
# motions slowed below this part of the solver's speed are given up
_SLOWEST = 0.7


def smooth_path(knots: Knots) -> JointPath:
    """The spline through the knots, over a parameter that is the time but for its ends."""
    t = knots.time
    first = _RAMP * t[1]
    last = _RAMP * (t[-1] - t[-2])
    half = t[-1] / 2
    top = _ramped(np.array([half, half]), np.array([first, last])).sum()
    s = np.where(t < half, _ramped(t, first), top - _ramped(t[-1] - t, last))
    return JointPath.through(s, knots.q)


def _ramped(t: Array, ramp: Array | float) -> Array:
    return np.asarray(np.where(t < ramp, t**3 / (3 * ramp**2), t - 2 * ramp / 3))


def smooth_outcome(
    dynamics: PathDynamics, path: JointPath, limits: MotionLimits, torque_rate: Array
) -> MotionOutcome:
    """The fastest motion along a path that keeps the torque rate, bounded at every instant.

    Raises:
        InfeasibleError: there is none.
    """
    limited = limits.with_rates(torque_rate, None)
    law = time_rate_limited(dynamics, path, limited, count=_COUNT)
    return outcome(Certificate(path, law, limited), dynamics)


def rate_excess(dynamics: PathDynamics, knots: Knots, torque_rate: Array) -> Array:
    """Largest torque rate sampled inside each interval of the knots' spline over its limit, shape
    (m, n).

    A program that limits differences of knots limits the mean only.
    """
    model = dynamics.model
    path = clamped(knots.time, knots.q)
    step = np.diff(knots.time)
    part = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    part[[0, -1]] = 0.01, 0.99
    t = (knots.time[:-1, None] + part * step[:, None]).ravel()
    piece = np.repeat(np.arange(len(step)), _SAMPLES)

    def moving(time: Array) -> Array:
        """Torque without dry friction."""
        q, qd, qdd = (path.on_piece(time, piece, order) for order in (0, 1, 2))
        return np.asarray(model.inverse_dynamics(q, qd, qdd) - FrictionLaw.of(model.robot).dry(qd))

    change = np.abs(moving(t + _STEP) - moving(t - _STEP)) / (2 * _STEP)
    return np.asarray((change / torque_rate).reshape(len(step), _SAMPLES, -1).max(axis=1))


def slowed_outcome(
    dynamics: PathDynamics, path: JointPath, limits: MotionLimits, torque_rate: Array | None = None
) -> MotionOutcome:
    """The motion of a spline over time itself, all of it slowed by one factor where the limits need
    it.

    Raises:
        InfeasibleError: not even at 0.7 of its speed.
    """
    s = grid(path, 1000)
    speed = 1.0
    for _ in range(8):
        law = PiecewiseConstantLaw(s, np.full(len(s), speed**2))
        found = outcome(Certificate(path, law, limits), dynamics)
        change = 1.0 if torque_rate is None else float((found.torque_rate / torque_rate).max())
        # torque falls with the square of the speed, but for gravity and friction: a little more
        # than the root
        excess = max(found.checked.torque_ratio**0.6, found.checked.velocity_ratio, np.cbrt(change))
        if excess <= 1:
            return found
        speed *= (1 - 1e-4) / excess
        if not speed > _SLOWEST:
            break
    raise InfeasibleError(
        "what the optimiser found breaks the limits between its knots; try more intervals"
    )
