"""One request to ruckig: the time-optimal move inside boxes of speed, acceleration and jerk, from
rest along the straight line in joint space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError, InputError

_LEAST_SHARE = 1e-9  # of the longest way: an axis that moves less limits nothing


@dataclass(frozen=True)
class RuckigMove:
    """ruckig's move of some numbers; the joints are `start + numbers @ carried`."""

    trajectory: Any
    start: Array
    carried: Array
    """shape (numbers, n): the identity, or the one row of a straight line"""

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.trajectory.duration)

    def states(self, time: Array) -> tuple[Array, Array, Array]:
        """q, qd, qdd at the times, each (m, n)."""
        rows = np.array([self.trajectory.at_time(t) for t in time])
        q, qd, qdd = (rows[:, k] @ self.carried for k in range(3))
        return self.start + q, qd, qdd

    def instants(self) -> Array:
        """Where the torque is sampled [s], shape (m,): 1 kHz (3000 instants of a long move), every
        switch of jerk, and densely where a joint starts, stops or turns (static friction acts only
        below some mrad/s)."""
        duration = self.duration
        grid = np.linspace(0.0, duration, int(min(1e3 * duration, 3000.0)) + 2)
        switches = [
            profile.brake.duration + np.cumsum([0.0, *profile.t])
            for section in self.trajectory.profiles
            for profile in section
        ]
        near = np.geomspace(1e-6, 5e-3, 20)
        speed = self.states(grid)[1]
        turns = [
            np.linspace(grid[k], grid[k + 1], 12)
            for k in np.flatnonzero((speed[1:] * speed[:-1] < 0).any(axis=1))
        ]
        time = np.concatenate([grid, near, duration - near, *switches, *turns])
        return np.unique(np.clip(time, 0.0, duration))


def ruckig_move(
    start: Sequence[Array], target: Array, boxes: Sequence[Array], rate: float
) -> RuckigMove:
    """The time-optimal move to rest at the target; a whole number of rows long.

    From rest one number moves, the way of the axis that turns furthest, and takes all axes along:
    with a number for each, ruckig leaves the straight line without a word where the profile of the
    slowest axis is too much for another.

    Args:
        start: angles, speeds and accelerations [rad, rad/s, rad/s2], each (n,).
        target: angles [rad], shape (n,).
        boxes: largest speeds, accelerations and jerks [rad/s, rad/s2, rad/s3], each (n,).
        rate: of the rows [1/s].

    Raises:
        InputError: what ruckig refuses. InfeasibleError: there is no move, or none that it can
        time.
    """
    q, qd, qdd = start
    way = target - q
    if qd.any() or qdd.any():
        trajectory = _calculated((np.zeros_like(q), qd, qdd), way, boxes, rate)
        return RuckigMove(trajectory, q, np.eye(q.size))
    longest = np.abs(way).max()
    shares = way / longest if longest > 0 else np.zeros_like(way)
    least = np.maximum(np.abs(shares), _LEAST_SHARE)
    along = [np.array([(box / least).min()]) for box in boxes]
    rest = 3 * [np.zeros(1)]
    trajectory = _calculated(rest, np.array([longest]), along, rate)
    return RuckigMove(trajectory, q, shares[None])


def _calculated(state: Sequence[Array], target: Array, boxes: Sequence[Array], rate: float) -> Any:
    import ruckig

    n = target.size
    generator = ruckig.Ruckig(n, 1.0 / rate)
    order = ruckig.InputParameter(n)
    trajectory = ruckig.Trajectory(n)
    order.current_position = state[0].tolist()
    order.current_velocity = state[1].tolist()
    order.current_acceleration = state[2].tolist()
    order.target_position = target.tolist()
    order.max_velocity = boxes[0].tolist()
    order.max_acceleration = boxes[1].tolist()
    order.max_jerk = boxes[2].tolist()
    order.synchronization = ruckig.Synchronization.Phase
    order.duration_discretization = ruckig.DurationDiscretization.Discrete
    try:
        result = generator.calculate(order, trajectory)
    except RuntimeError as error:
        raise InputError(f"joint move: ruckig refused the request: {error}") from error
    except ValueError as error:  # a result without a name: a move of more than two hours
        raise InfeasibleError(
            "a move within these limits takes hours; expected larger limits of acceleration or "
            "jerk, or a start from rest"
        ) from error
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        raise InfeasibleError(
            f"ruckig found no move ({result.name}); try other limits or start from rest"
        )
    return trajectory
