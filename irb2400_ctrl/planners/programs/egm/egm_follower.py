"""The answers to a controller's messages: where the plan is on the controller's own clock."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.egm import egm_messages as proto
from irb2400_ctrl.planners.programs.egm.egm_report import EgmError, EgmOptions, EgmReport
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.typed import typed

# no controller sends faster than this [s]
_CYCLE = 0.004


@typed
class EgmFollower:
    """The answers to a controller's messages: all of the stream but the socket."""

    def __init__(
        self,
        robot: Robot,
        time: Trajectory | ArrayLike,
        q: ArrayLike | None = None,
        qd: ArrayLike | None = None,
        options: EgmOptions | None = None,
    ) -> None:
        """A plan from rest to rest.

        Args:
            time: the plan; or only its times [s], shape (n,), increasing, and then
            q, qd: its actuator angles and speeds [rad, rad/s], shape (n, 6). q3 is absolute, as ABB
                counts axis 3.

        Raises:
            InputError: shapes, order, not finite, outside the joint box or the speed limits, not at
            rest at an end.
        """
        self.options = options or EgmOptions()
        self.time, self.q, self.qd = _checked(robot, time, q, qd)
        self.plan_time = 0.0
        self.running = False
        self.done = False
        self._rate = 1.0
        self._stopping = False
        self._last: proto.RobotMessage | None = None
        self._waited = 0.0
        self._clock = 0.0
        self._standing = 0
        self._sent = 0
        self._lost = self._late = 0
        self._log: list[tuple[float, Array, Array]] = []

    def stop(self) -> None:
        """Slow down along the path and stand still."""
        self._stopping = True

    def answer(self, message: proto.RobotMessage) -> proto.SensorMessage | None:
        """The next reference, or None for a message that is older than one already answered.

        Raises:
            EgmError: the arm is not where the plan starts, too far from the plan, a measured angle
            is no number, the clock stands, or EGM no longer runs.
        """
        elapsed = self._elapsed(message)
        if elapsed is None:
            self._late += 1
            return None
        self._last = message
        measured = np.radians(message.q_deg)
        if len(measured) != self.q.shape[1]:
            raise self.failure(
                f"the controller sends {len(measured)} axes, expected {self.q.shape[1]}"
            )
        if not np.isfinite(measured).all():
            axis = int(np.argmin(np.isfinite(measured)))
            raise self.failure(
                f"the measured angle of axis {axis + 1} is {message.q_deg[axis]}, expected a number"
            )
        ready = message.mci_state == proto.MCI_RUNNING and message.motor_state in (
            None,
            proto.MOTORS_ON,
        )
        if not self.running and ready:
            self._begin(measured)
        elif self.running:
            if not ready:
                raise self.failure(
                    f"EGM left the running state (state {message.mci_state}, motors "
                    f"{message.motor_state})"
                )
            self._advance(elapsed)
        q, qd = self.reference(self.plan_time)
        qd = qd * (self._rate if self.running else 0.0)
        if self.running:
            self._log.append((self._clock, q, measured))
            self._watch(message, q, measured, elapsed)
        self._sent += 1
        speeds = tuple(np.degrees(qd).tolist()) if self.options.send_speed else ()
        return proto.SensorMessage(
            self._sent, message.time_ms, tuple(np.degrees(q).tolist()), speeds
        )

    def reference(self, t: float) -> tuple[Array, Array]:
        """q and qd of the plan at time t: the cubic through both ends' angles and speeds [rad,
        rad/s]."""
        t = float(np.clip(t, self.time[0], self.time[-1]))
        k = int(np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.time) - 2))
        h = self.time[k + 1] - self.time[k]
        u = (t - self.time[k]) / h
        q0 = self.q[k]
        q1 = self.q[k + 1]
        m0 = h * self.qd[k]
        m1 = h * self.qd[k + 1]
        a = 2 * (q0 - q1) + m0 + m1
        b = 3 * (q1 - q0) - 2 * m0 - m1
        return q0 + u * (m0 + u * (b + u * a)), (m0 + u * (2 * b + u * 3 * a)) / h

    def report(self, outcome: Literal["finished", "stopped", "failed"] | None = None) -> EgmReport:
        """What happened so far."""
        width = self.q.shape[1]
        return EgmReport(
            outcome or ("stopped" if self._stopping else "finished"),
            np.array([row[0] for row in self._log]),
            np.array([row[1] for row in self._log]).reshape(-1, width),
            np.array([row[2] for row in self._log]).reshape(-1, width),
            self._lost,
            self._late,
        )

    def failure(self, reason: str) -> EgmError:
        """The error that ends the stream; without answers the controller stops by its own
        communication timeout."""
        place = (
            f"at {self.plan_time:.3f} s of {self.time[-1]:.3f} s"
            if self.running
            else "before the plan began"
        )
        return EgmError(f"EGM stopped {place}: {reason}", self.report("failed"))

    def _elapsed(self, message: proto.RobotMessage) -> float | None:
        """Controller's time since the last message [s]; None if this one is no newer. Both counters
        may wrap."""
        if self._last is None:
            return 0.0
        ahead = (message.sequence - self._last.sequence) % proto.CLOCK
        if ahead == 0 or ahead > proto.CLOCK // 2:
            return None
        self._lost += ahead - 1
        elapsed = 1e-3 * ((message.time_ms - self._last.time_ms) % proto.CLOCK)
        self._watch_clock(ahead, elapsed)
        if self.running and elapsed > self.options.timeout:
            raise self.failure(
                f"{ahead - 1} messages of the controller got lost in a row ({elapsed:.3f} s, "
                "expected at most "
                f"{self.options.timeout:.3f} s); the jump to the plan would be too large"
            )
        return elapsed

    def _watch_clock(self, ahead: int, elapsed: float) -> None:
        """Does the controller's clock go on with its messages? Else the plan would stand for
        ever."""
        self._standing = self._standing + ahead if elapsed == 0.0 else 0
        if not self.running:
            return
        if elapsed > 1e-3 * proto.CLOCK / 2:
            raise self.failure("the controller's clock runs backwards")
        if self._standing * _CYCLE > self.options.timeout:
            raise self.failure(
                f"the controller's clock has stood still for {self._standing} messages, expected "
                f"it to go on within {self.options.timeout:.3f} s"
            )

    def _begin(self, measured: Array) -> None:
        away = np.degrees(np.abs(measured - self.q[0]))
        axis = int(np.argmax(away))
        if away[axis] > self.options.start_tolerance_deg:
            raise self.failure(
                f"axis {axis + 1} stands {away[axis]:.2f} deg from the plan's start, expected at "
                "most "
                f"{self.options.start_tolerance_deg:.2f}; move there first (MoveAbsJ)"
            )
        self.running = True
        self.plan_time = float(self.time[0])

    def _advance(self, elapsed: float) -> None:
        self._clock += elapsed
        before = self._rate
        if self._stopping:
            self._rate = max(0.0, before - elapsed / self.options.stop_time)
        self.plan_time = min(
            self.plan_time + 0.5 * (before + self._rate) * elapsed, float(self.time[-1])
        )

    def _watch(
        self, message: proto.RobotMessage, q: Array, measured: Array, elapsed: float
    ) -> None:
        """Has the arm arrived, or lost the plan?"""
        away = np.degrees(np.abs(measured - q))
        axis = int(np.argmax(away))
        if away[axis] > self.options.following_tolerance_deg:
            raise self.failure(
                f"axis {axis + 1} is {away[axis]:.1f} deg from the plan, expected at most "
                f"{self.options.following_tolerance_deg:.1f}"
            )
        if self.plan_time < self.time[-1] and self._rate > 0.0:
            return
        self._waited += elapsed
        self.done = bool(away[axis] <= self.options.end_tolerance_deg)
        if not self.done and self._waited > self.options.settle_timeout:
            raise self.failure(
                f"axis {axis + 1} is still {away[axis]:.3f} deg from the end after "
                f"{self._waited:.1f} s, expected at "
                f"most {self.options.end_tolerance_deg:.3f}"
            )


def _checked(
    robot: Robot, motion: Trajectory | ArrayLike, *angles: ArrayLike | None
) -> tuple[Array, Array, Array]:
    if isinstance(motion, Trajectory):
        if any(values is not None for values in angles):
            raise InputError("EGM: found a trajectory and angles besides, expected one of them")
        if motion.external is not None:
            raise InputError(
                "EGM: found a motion with external axes, expected the six joints of the arm alone: "
                "nothing would turn the part; write RAPID"
            )
        time = motion.time
        q = motion.q
        qd = motion.qd
    else:
        time, q, qd = (np.array(values, dtype=float) for values in (motion, *angles))
    if (
        q.ndim != 2
        or q.shape[1] != robot.n
        or len(q) < 2
        or time.shape != (len(q),)
        or qd.shape != q.shape
    ):
        raise InputError(
            f"EGM: found time {time.shape}, q {q.shape}, qd {qd.shape}, expected (m,) and twice "
            f"(m, {robot.n}), m >= 2"
        )
    if not all(np.isfinite(array).all() for array in (time, q, qd)):
        raise InputError("EGM: time, q or qd is not finite")
    if (np.diff(time) <= 0).any():
        raise InputError(
            f"EGM: time does not increase at row {int(np.argmax(np.diff(time) <= 0)) + 2}"
        )
    excess = np.maximum(robot.q_min - q, q - robot.q_max)
    if excess.max() > 1e-6:
        row, axis = np.unravel_index(int(np.argmax(excess)), excess.shape)
        raise InputError(
            f"EGM: axis {axis + 1} is outside its range at row {row + 1}: "
            f"{np.degrees(q[row, axis]):.2f} deg"
        )
    fast = np.abs(qd) / robot.qd_max
    if fast.max() > 1 + 1e-6:
        row, axis = np.unravel_index(int(np.argmax(fast)), fast.shape)
        raise InputError(f"EGM: axis {axis + 1} is faster than its limit at row {row + 1}")
    if np.abs(qd[[0, -1]]).max() > 1e-3:
        raise InputError("EGM: the plan does not start and end at rest")
    return time, q, qd
