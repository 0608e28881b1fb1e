"""Limits of a motion, looked at densely: joint box, speed, acceleration, torque, and room around
the foot of the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.excitation.acceleration import AccelerationLimits
from irb2400_ctrl.excitation.room import floor_and_column, height_and_radius, ranges_kept
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

SHARE = 0.9
"""of torque, speed and acceleration limits that an excitation uses; the rest is the controller's"""
DENSE = 4
"""instants looked at per row of a trajectory"""


@dataclass(frozen=True)
class Extent:
    """How far a motion goes.

    Args:
        torque, speed: largest share of the limits; box: smallest distance from the joint box,
            negative outside [rad].
        height, radius: smallest of flange and TCP above the base plane and from axis 1 [m].
        floor, column: what these must be at least [m].
        acceleration: largest share of the limits, assumed ones where the file states none.
    """

    torque: float
    speed: float
    box: float
    height: float
    radius: float
    floor: float
    column: float
    acceleration: float

    @property
    def inside(self) -> bool:
        """Within everything."""
        driven = self.torque <= SHARE and self.speed <= 1.0 and self.acceleration <= 1.0
        return driven and self.box >= 0 and self.clear

    def summary(self, robot: Robot) -> dict[str, Any]:
        """For `excitation.json`, with the accelerations that the robot's motions keep."""
        limits = AccelerationLimits.of(robot)
        return {
            "max_torque_ratio": self.torque,
            "max_velocity_ratio": self.speed,
            "max_acceleration_ratio": self.acceleration,
            "acceleration_limits_deg_s2": np.degrees(limits.values).tolist(),
            "acceleration_assumed_of_joints": list(limits.assumed),
            "ranges_kept_deg": ranges_kept(robot),
            "smallest_distance_from_joint_box_deg": float(np.degrees(self.box)),
            "smallest_height_m": self.height,
            "smallest_radius_m": self.radius,
        }

    def shares(self) -> str:
        """Of the limits that a motor has, and what is left of the ranges, in words."""
        return (
            f"{np.degrees(self.box):.1f} deg or more inside the ranges used; torque at most "
            f"{100 * self.torque:.0f} % of its limit, speed {100 * self.speed:.0f} %, acceleration "
            f"{100 * self.acceleration:.0f} %"
        )

    def wrong(self) -> str:
        """What is not within, and what would help."""
        said = []
        if self.torque > SHARE:
            said.append(
                f"ask for {100 * self.torque:.0f} % of a torque limit, expected at most "
                f"{100 * SHARE:.0f} %: check the torque limits"
            )
        if self.speed > 1.0:
            said.append(f"ask for {100 * self.speed:.0f} % of a speed limit: check these limits")
        if self.acceleration > 1.0:
            said.append(
                f"ask for {100 * self.acceleration:.0f} % of an acceleration limit: check "
                "acceleration_deg_s2"
            )
        if self.box < 0.0:
            said.append(f"leave the joint box by {np.degrees(-self.box):.2g} deg: check the ranges")
        if self.height < self.floor:
            said.append(
                f"come to {self.height:.3f} m above the base plane, expected {self.floor:.3f} m"
            )
        if self.radius < self.column:
            said.append(
                f"come to {self.radius:.3f} m from axis 1, expected {self.column:.3f} m: a "
                "narrower range of axis 2 or 3 keeps them outside"
            )
        return "; they ".join(said)

    @property
    def clear(self) -> bool:
        """Away from floor and foot."""
        return self.height >= self.floor and self.radius >= self.column


def extent(model: Model, q: Array, qd: Array, qdd: Array) -> Extent:
    """Of states (m, n); torque with friction and effects.

    Args:
        model: of the arm.
        q: [rad].
        qd: [rad/s].
        qdd: [rad/s2].
    """
    robot = model.robot
    tau = model.inverse_dynamics(q, qd, qdd)
    height, radius = height_and_radius(model, q)
    floor, column = floor_and_column(robot)
    box = float(np.minimum(q - robot.q_min, robot.q_max - q).min())
    if robot.coupling.difference_deg is not None:
        low, high = np.radians(robot.coupling.difference_deg)
        difference = q[:, 2] - q[:, 1]
        box = min(box, float(np.minimum(difference - low, high - difference).min()))
    return Extent(
        torque=float((np.abs(tau) / robot.tau_max).max()),
        speed=float((np.abs(qd) / robot.qd_max).max()),
        box=box,
        height=float(height.min()),
        radius=float(radius.min()),
        floor=floor,
        column=column,
        acceleration=AccelerationLimits.of(robot).ratio(qdd),
    )


def with_share(robot: Robot) -> Robot:
    """The robot with `SHARE` of its limits of torque, speed and acceleration (assumed ones where it
    states none): what is planned for it leaves the rest free."""
    joints = []
    bends = AccelerationLimits.of(robot).values
    shared = zip(robot.joints, robot.tau_max, robot.qd_max, bends, strict=True)
    for joint, torque, speed, bend in shared:
        limits = joint.limits.model_copy(
            update={
                "torque_Nm": SHARE * torque,
                "speed_deg_s": float(np.degrees(SHARE * speed)),
                "acceleration_deg_s2": float(np.degrees(SHARE * bend)),
            }
        )
        joints.append(joint.model_copy(update={"limits": limits}))
    return robot.model_copy(update={"joints": tuple(joints)})


def between(course: Trajectory, at: Array) -> tuple[Array, Array, Array]:
    """q, qd, qdd of a motion at the times `at` [s], shape (k,): polynomials of degree 5 through the
    three values of its rows, which are evenly spaced from 0 s on."""
    q = course.q
    qd = course.qd
    qdd = course.qdd
    h = float(course.time[1])
    k = np.clip((at / h).astype(int), 0, len(q) - 2)
    x = ((at - k * h) / h)[:, None]
    p0 = q[k]
    v0 = qd[k] * h
    a0 = qdd[k] * h**2
    d = q[k + 1] - p0
    v1 = qd[k + 1] * h
    a1 = qdd[k + 1] * h**2
    c3 = 10 * d - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1
    c4 = -15 * d + 8 * v0 + 7 * v1 + 1.5 * a0 - a1
    c5 = 6 * d - 3 * (v0 + v1) - 0.5 * (a0 - a1)
    value = p0 + x * (v0 + x * (a0 / 2 + x * (c3 + x * (c4 + x * c5))))
    rate = (v0 + x * (a0 + x * (3 * c3 + x * (4 * c4 + 5 * x * c5)))) / h
    bend = (a0 + x * (6 * c3 + x * (12 * c4 + 20 * x * c5))) / h**2
    return value, rate, bend


def dense_extent(model: Model, course: Trajectory) -> Extent:
    """Of a whole motion, at `DENSE` instants per row."""
    steps = len(course.q) - 1
    at = np.linspace(0.0, course.time[1] * steps, DENSE * steps + 1)
    return extent(model, *between(course, at))
