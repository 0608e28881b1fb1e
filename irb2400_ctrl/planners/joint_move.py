"""Jerk-limited synchronised joint moves: to the start of a path, between paths, and on to a target
after a stop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError, InputError
from irb2400_ctrl.given import numbers, positive
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.joint_box import can_hold, inside_box, outside_box
from irb2400_ctrl.planners.ruckig_move import RuckigMove, ruckig_move
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.trajectory.trajectory import RATE
from irb2400_ctrl.typed import typed

# time from zero to full acceleration where no jerk limit is given [s]: an assumption, nothing is
# published
RAMP_TIME = 0.05
# torque is checked at instants, not enclosed: this share is kept free for what lies between them
# [-]
FREE_SHARE = 0.002
LEAST_INERTIA = 1e-12  # an axis that has less turns nothing [kg m2]
_SCALES = np.geomspace(4.0, 0.02, 14)
_SPEED_SHARES = (1.0, 0.7, 0.5, 0.3, 0.15)


@dataclass(frozen=True)
class JointMove:
    """A move of all joints that starts and ends together."""

    trajectory: Trajectory
    """equidistant rows, the last one at rest; a single one where there is nothing to do"""
    qdd_max: Array
    """acceleration limits that the move was made with, after scaling to the torque [rad/s2], shape
    (n,)"""
    qddd_max: Array
    """jerk limits that the move was made with [rad/s3], shape (n,)"""
    max_torque_ratio: float
    """largest |tau| / tau_max over the move, friction and effects included [-]"""

    def __post_init__(self) -> None:
        for array in (self.qdd_max, self.qddd_max):
            array.setflags(write=False)

    @property
    def time(self) -> Array:
        """[s], shape (m,)"""
        return self.trajectory.time

    @property
    def q(self) -> Array:
        """[rad], shape (m, n)"""
        return self.trajectory.q

    @property
    def qd(self) -> Array:
        """[rad/s], shape (m, n)"""
        return self.trajectory.qd

    @property
    def qdd(self) -> Array:
        """[rad/s2], shape (m, n)"""
        return self.trajectory.qdd

    @property
    def duration(self) -> float:
        """[s]"""
        return self.trajectory.duration


@typed
def joint_move(
    model: Model,
    q_start: ArrayLike,
    q_target: ArrayLike,
    *,
    qd_start: ArrayLike | None = None,
    qdd_start: ArrayLike | None = None,
    qdd_max: ArrayLike | None = None,
    qddd_max: ArrayLike | None = None,
    rate: float = RATE,
) -> JointMove:
    """The fastest jerk-limited move found from the start state to rest at the target, inside the
    torque limits.

    ruckig gives the time-optimal move for boxes of speed, acceleration and jerk; those of
    acceleration and jerk are scaled together until inverse dynamics stays within the torque limits
    (friction and effects included), and the speed as well where friction at full speed alone is too
    much.

    Args:
        model: the arm, with its limits.
        q_start, q_target: actuator angles inside the joint box [rad], shape (n,).
        qd_start, qdd_start: state at the start, default rest [rad/s, rad/s2], shape (n,).
        qdd_max: upper limits of acceleration [rad/s2], shape (n,); default those of the robot file,
            on an axis without one what the torque leaves of it (then scaled up as well as down).
        qddd_max: upper limits of jerk [rad/s3], shape (n,); default `qdd_max` reached in 50 ms.
        rate: of the rows; the duration is a whole number of them [1/s].

    Raises:
        InputError: a vector of another length, not finite, or outside the joint box or the limits
        of speed and acceleration. InfeasibleError: the torque limits or the joint box leave no
        move; names axis and place.
    """
    robot = model.robot
    start = _vector("q_start", q_start, robot.n)
    target = _vector("q_target", q_target, robot.n)
    speed = _vector("qd_start", np.zeros(robot.n) if qd_start is None else qd_start, robot.n)
    acceleration = _vector(
        "qdd_start", np.zeros(robot.n) if qdd_start is None else qdd_start, robot.n
    )
    positive("rate", rate, "rows per second")
    for name, q in (("q_start", start), ("q_target", target)):
        inside_box(model, name, q)
        can_hold(model, name, q)
    _within("qd_start", "deg/s", speed, robot.qd_max)
    if qdd_max is None:
        stated = MotionLimits.of(robot).qdd_max
    else:
        stated = _vector("qdd_max", qdd_max, robot.n, positive=True)
    _within("qdd_start", "deg/s2", acceleration, stated)
    known = np.isfinite(stated)
    box = stated if known.all() else _accelerations(model, start, target, stated)
    if qddd_max is None:
        jerk = box / RAMP_TIME
    else:
        jerk = _vector("qddd_max", qddd_max, robot.n, positive=True)
    # what somebody stated is never exceeded; what was only estimated may be scaled up
    top = 1.0 if known.all() or qddd_max is not None else _SCALES[0]
    return _Search(model, start, target, speed, acceleration, box, jerk, rate, known).best(top)


def _vector(name: str, value: ArrayLike, n: int, positive: bool = False) -> Array:
    """`value` as a finite vector of length n: ruckig itself would take any length without a
    word."""
    array = numbers(name, value)
    if array.shape != (n,):
        raise InputError(f"{name} has shape {array.shape}, expected ({n},): one value per axis")
    if not np.isfinite(array).all():
        raise InputError(
            f"{name}: the value of axis {int(np.argmin(np.isfinite(array))) + 1} is not finite"
        )
    if positive and (array <= 0).any():
        axis = int(np.argmin(array))
        raise InputError(
            f"{name}: the limit of axis {axis + 1} is {array[axis]}, expected a positive number"
        )
    return array


def _within(name: str, unit: str, found: Array, most: Array) -> None:
    """Refuse a start beyond the limits of speed or acceleration.

    Args:
        name: of the start's part; unit: with degrees; found, most: with radians, each (n,).
    """
    if (np.abs(found) > most * (1 + 1e-9)).any():
        axis = int(np.argmax(np.abs(found) / most))
        raise InputError(
            f"{name}: axis {axis + 1} has {np.degrees(found[axis]):.1f} {unit}, "
            f"expected at most {np.degrees(most[axis]):.1f}"
        )


def _accelerations(model: Model, start: Array, target: Array, stated: Array) -> Array:
    """What is stated, and where that is infinite what gravity and friction leave to each axis alone
    along the straight line in joint space [rad/s2].

    Args:
        model: the arm.
        start, target: ends of the line [rad], shape (n,).
        stated: accelerations [rad/s2], shape (n,).

    Raises:
        InputError: an axis of which nothing is stated and that turns nothing with an inertia.
    """
    q = start + np.linspace(0.0, 1.0, 9)[:, None] * (target - start)
    limit = model.robot.tau_max
    left = limit - np.abs(model.gravity(q)).max(axis=0) - np.abs(model.friction(model.robot.qd_max))
    inertia = np.diagonal(model.mass_matrix(q), axis1=1, axis2=2).max(axis=0)
    idle = ~np.isfinite(stated) & (inertia < LEAST_INERTIA)
    if idle.any():
        raise InputError(
            f"axis {int(np.argmax(idle)) + 1} turns nothing that has an inertia in the file of "
            f"{model.robot.name}, so no torque limits its acceleration; expected qdd_max, or "
            "acceleration_deg_s2 in its limits"
        )
    alone = np.maximum(left, 0.1 * limit) / np.maximum(inertia, LEAST_INERTIA)
    return np.where(np.isfinite(stated), stated, alone)


@dataclass(frozen=True)
class _Search:
    """The moves between two states as the boxes of acceleration and jerk are scaled."""

    model: Model
    start: Array
    target: Array
    qd: Array
    qdd: Array
    qdd_max: Array
    qddd_max: Array
    rate: float
    stated: Array
    """which accelerations somebody stated, shape (n,): they are scaled down only"""

    def scales(self, scale: float) -> Array:
        """By what the boxes of each axis are multiplied, shape (n,)."""
        return np.where(self.stated, min(scale, 1.0), scale)

    def best(self, top: float) -> JointMove:
        """The shortest move inside the torque limits over scales up to `top` and a few shares of
        the speed."""
        found: tuple[float, RuckigMove, float, float] | None = None
        last: InfeasibleError | None = None
        for share in _SPEED_SHARES:
            if (np.abs(self.qd) > share * self.model.robot.qd_max * (1 + 1e-9)).any():
                break
            try:
                scale, trajectory, ratio = self._largest_scale(top, share)
            except InfeasibleError as error:
                last = error
                continue
            if found is not None and trajectory.duration >= found[1].duration:
                break
            found = (scale, trajectory, ratio, share)
        if found is None:
            assert last is not None
            raise last
        return self._sampled(*found[:3])

    def _largest_scale(self, top: float, share: float) -> tuple[float, RuckigMove, float]:
        """The largest scale whose move keeps torque and box, to 1 %. Tried from above: with speed
        at the start a small scale may brake too late for the box, so what is feasible need not be
        everything below some scale."""
        scales = [top, *_SCALES[top > _SCALES]]
        first: InfeasibleError | None = None
        for position, scale in enumerate(scales):
            try:
                trajectory, ratio = self._tried(scale, share)
            except InfeasibleError as error:
                first = first or error
                continue
            low = scale
            high = scales[position - 1] if position else scale
            while high / low > 1.01:
                middle = float(np.sqrt(low * high))
                try:
                    trajectory, ratio = self._tried(middle, share)
                    low = middle
                except InfeasibleError:
                    high = middle
            return low, trajectory, ratio
        assert first is not None
        raise InfeasibleError(
            "joint move: no acceleration down to 2 % of the estimate is possible; at the first "
            f"try {first}"
        )

    def _tried(self, scale: float, share: float) -> tuple[RuckigMove, float]:
        """ruckig's move at this scale and its largest torque ratio; InfeasibleError where it breaks
        torque or box."""
        trajectory = self._ruckig(scale, share)
        time = trajectory.instants()
        q, qd, qdd = trajectory.states(time)
        problem = outside_box(self.model, q)
        if problem is not None:
            raise InfeasibleError(
                f"the move swings out of the joint box before it turns: {problem}"
            )
        ratio = np.abs(self.model.inverse_dynamics(q, qd, qdd)) / self.model.robot.tau_max
        worst = float(ratio.max())
        if worst > 1.0 - FREE_SHARE:
            row, axis = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
            limit = self.model.robot.tau_max[axis]
            raise InfeasibleError(
                f"at {time[row]:.3f} s axis {axis + 1} needs {ratio[row, axis] * limit:,.0f} of "
                f"{limit:,.0f} Nm"
            )
        return trajectory, worst

    def _ruckig(self, scale: float, share: float) -> RuckigMove:
        scales = self.scales(scale)
        boxes = (
            share * self.model.robot.qd_max,
            scales * self.qdd_max,
            scales * self.qddd_max,
        )
        return ruckig_move((self.start, self.qd, self.qdd), self.target, boxes, self.rate)

    def _sampled(self, scale: float, trajectory: RuckigMove, ratio: float) -> JointMove:
        count = round(trajectory.duration * self.rate)
        time = np.arange(count + 1) / self.rate
        rows = Trajectory(time, *trajectory.states(time), check_speeds=False)
        own = self.scales(scale)
        return JointMove(rows, own * self.qdd_max, own * self.qddd_max, ratio)
