"""`KnotCoupling`: objective and constraints between neighbouring knots of a `Transcription`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.robot import Robot

Objective = Literal["time", "energy"]

# weight of the mean squared acceleration: makes the motion of joints that limit nothing unique
_SMOOTH = 2e-4
# of the duration as a part of its guess: the barrier leaves its tolerance times the number of
# active rows at the end
_SCALE = 100.0


@dataclass(frozen=True, eq=False)
class _Row:
    """low <= value <= high, entry by entry."""

    value: ca.SX
    low: float | Array
    high: float | Array

    def spread(self, bound: float | Array) -> Array:
        """A bound of every entry, shape (entries,)."""
        return np.broadcast_to(np.asarray(bound, dtype=float), (self.value.numel(),))


@dataclass(frozen=True, eq=False)
class KnotCoupling:
    """What couples knots: bilinear in all variables, and cheap."""

    robot: Robot
    limits: MotionLimits
    accelerations: Array
    """unit of the acceleration variables [rad/s2], shape (n,)"""
    intervals: tuple[int, ...]
    """number of intervals of each segment"""
    step: Array
    """unit of each segment's interval length [s]"""
    objective: Objective
    duration: float
    """upper bound [s]"""
    torque_rate: Array | None
    """[Nm/s], shape (n,) or (m, n)"""
    paired: bool
    """whether every second knot's acceleration is the mean of its neighbours'"""
    extra: int
    """further variables of a knot: power and torque"""

    @property
    def knots(self) -> int:
        """Number of knots."""
        return sum(self.intervals) + 1

    @cached_property
    def segment(self) -> npt.NDArray[np.int64]:
        """Segment of each interval."""
        return np.repeat(np.arange(len(self.intervals)), self.intervals)

    def function(self) -> tuple[ca.Function, Array, Array]:
        """x -> (objective, rows that couple knots), and the bounds of these rows."""
        n = self.robot.n
        knots = self.knots
        width = 3 * n
        x = ca.SX.sym("x", knots * (width + self.extra) + len(self.intervals))
        w = ca.reshape(x[: knots * width], width, knots)
        extra = ca.reshape(x[knots * width : knots * (width + self.extra)], self.extra, knots)
        dt_k = x[-len(self.intervals) :] * ca.DM(self.step)
        belongs = ca.DM(np.eye(len(self.intervals))[self.segment])
        dt = ca.repmat((belongs @ dt_k).T, n, 1)
        total = ca.dot(dt_k, ca.DM(np.array(self.intervals, dtype=float)))
        rows = self._motion_rows(w, dt)
        if self.torque_rate is not None:
            rows += self._rate_rows(extra[-n:, :], dt)
        if np.isfinite(self.duration):
            rows.append(_Row(total / self.duration, -np.inf, 1.0))
        objective = self._objective(w, extra, dt, total, float(self.step @ self.intervals))
        stacked = ca.vertcat(*(ca.vec(row.value) for row in rows))
        lower = np.concatenate([row.spread(row.low) for row in rows])
        upper = np.concatenate([row.spread(row.high) for row in rows])
        return ca.Function("coupling", [x], [objective, stacked]), lower, upper

    def _motion_rows(self, w: ca.SX, dt: ca.SX) -> list[_Row]:
        """What makes a cubic spline of the knots: continuity, joint box and speeds in between."""
        knots = self.knots
        robot = self.robot
        n = robot.n
        speed = ca.repmat(ca.DM(self.limits.qd_max), 1, knots - 1)
        q = w[:n, :]
        qd = w[n : 2 * n, :]
        qdd = w[2 * n :, :]
        v = qd * ca.repmat(ca.DM(self.limits.qd_max), 1, knots)
        a = qdd * ca.repmat(ca.DM(self.accelerations), 1, knots)
        first = slice(0, knots - 1)
        last = slice(1, knots)
        unit = ca.repmat(ca.DM(self.step[self.segment]).T, n, 1) * speed
        reached = dt * (v[:, first] + dt * (2 * a[:, first] + a[:, last]) / 6)
        gained = dt * (a[:, first] + a[:, last]) / 2 / speed
        rows = [
            _Row((q[:, last] - q[:, first] - reached) / unit, 0.0, 0.0),
            _Row(qd[:, last] - qd[:, first] - gained, 0.0, 0.0),
        ]
        # inner Bernstein coefficients of q: with the knots they enclose each cubic
        inner = [q[:, first] + dt * v[:, first] / 3, q[:, last] - dt * v[:, last] / 3]
        low = np.tile(robot.q_min, knots - 1)
        high = np.tile(robot.q_max, knots - 1)
        rows += [_Row(value, low, high) for value in inner]
        if self.paired:
            odd = np.arange(1, knots - 1, 2)
            around = qdd[:, (odd - 1).tolist()] + qdd[:, (odd + 1).tolist()]
            rows.append(_Row(qdd[:, odd.tolist()] - around / 2, 0.0, 0.0))
        # the speed is a parabola: with the knots themselves these coefficients enclose it
        rows.append(_Row((v[:, first] + dt * a[:, first] / 2) / speed, -1.0, 1.0))
        if robot.coupling.difference_deg is not None:
            bound = np.radians(robot.coupling.difference_deg)
            for value in (*inner, q):
                rows.append(_Row(value[2, :] - value[1, :], bound[0], bound[1]))
        return rows

    def _rate_rows(self, tau: ca.SX, dt: ca.SX) -> list[_Row]:
        """Change of the torque from knot to knot within its rate, in units of the torque limits."""
        assert self.torque_rate is not None
        knots = self.knots
        shape = (knots - 1, self.robot.n)
        rate = np.broadcast_to(self.torque_rate / self.limits.tau_max, shape)
        change = ca.DM(rate.T) * dt
        first = slice(0, knots - 1)
        last = slice(1, knots)
        return [
            _Row(tau[:, last] - tau[:, first] - change, -np.inf, 0.0),
            _Row(tau[:, last] - tau[:, first] + change, 0.0, np.inf),
        ]

    def _objective(
        self, w: ca.SX, extra: ca.SX, dt: ca.SX, total: ca.SX, reference: float
    ) -> ca.SX:
        """Duration, or energy over the duration of the guess, and a little of the accelerations."""
        knots = self.knots
        n = self.robot.n
        scale = _SCALE if self.objective == "time" else 1.0
        smooth = scale * _SMOOTH * ca.sumsqr(w[2 * n :, :]) / knots
        if self.objective == "time":
            return scale * total / reference + smooth
        unit = ca.DM(self.limits.tau_max * self.limits.qd_max / 1000.0)
        power = unit.T @ extra[:n, :]
        mean = (power[:, : knots - 1] + power[:, 1:]) / 2
        return ca.dot(dt[0, :], mean) / reference + smooth
