"""`certify`: what is sure of a timed tool path over all times, from its own numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.planners.enclosure.deviation import Deviation, deviation
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.external_bounds import AxisBounds, axis_bounds, stay_in_range
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.margins_as_read import followed_as_read
from irb2400_ctrl.planners.timing.certificate import Certificate, check
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.sampled_check import SAMPLED_NOTE
from irb2400_ctrl.planners.timing.sampled_reference.settled_reference import Settled
from irb2400_ctrl.planners.timing.sampled_timing import guarantee_note
from irb2400_ctrl.planners.timing.time_choices import TimedChoice
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.planners.toolpath.orientation import Orientation


@dataclass(frozen=True)
class JointBounds:
    """Upper bounds over all times of the rows of a motion of the joints, as they are read, and
    whether they are guaranteed."""

    certificate: Certificate
    guaranteed: bool
    note: str
    """why the torque bound is not guaranteed; empty where it is"""
    torque_ratio: float
    """largest |tau| over the robot's own limit; of samples where there is no bound"""
    velocity_ratio: float
    """largest |qd| over the robot's own limit"""
    acceleration_ratio: float | None
    """largest |qdd| over the robot's own limit; None where it states none"""
    external: tuple[AxisBounds, ...] = ()
    """of the axes that carry the part or the arm"""


@dataclass(frozen=True)
class PlanBounds:
    """Upper bounds over all times of the rows as they are read, of the joints and the TCP."""

    joints: JointBounds
    feed_ratio: float | None
    """speed of the TCP over the feed; None without a feed"""
    deviation: Deviation


def certify(
    dynamics: PathDynamics,
    orientation: Orientation,
    timed: TimedChoice,
    settled: Settled,
    options: TimingOptions,
) -> PlanBounds:
    """Bound everything that a plan promises, without the solver that found the motion.

    Raises:
        UnreachableError: an axis that carries the part leaves its range.
    """
    path = timed.path
    joints = certify_joints(dynamics, path.joints, settled, options)
    if path.tcp.carried is not None:
        stay_in_range(path.tcp.carried, joints.external)
    return PlanBounds(joints, settled.feed_ratio, _deviation(orientation, timed, settled))


def certify_joints(
    dynamics: PathDynamics, joints: JointPath, settled: Settled, options: TimingOptions
) -> JointBounds:
    """Bound torque, speed and acceleration of a timed joint path, whatever its TCP does."""
    robot = dynamics.model.robot
    limits = options.limits
    certificate = Certificate(joints, settled.law, limits, dynamics.carriage)
    checked = settled.own or check(certificate, dynamics.model, dynamics)
    kept = settled.bounded and settled.worst(limits) <= 1 and _rates_kept(checked, options)
    return JointBounds(
        certificate=certificate,
        guaranteed=options.certified and kept and not robot.weightless,
        note=_note(dynamics, checked, settled, kept, options),
        torque_ratio=float((settled.torque[: robot.n] / robot.tau_max).max()),
        velocity_ratio=settled.bounds.first(robot.n).velocity_ratio(robot.qd_max),
        acceleration_ratio=_acceleration_ratio(dynamics, settled),
        external=axis_bounds(
            settled.reference.places, settled.bounds, limits, robot.n, dynamics.lengths
        ),
    )


def _deviation(orientation: Orientation, timed: TimedChoice, settled: Settled) -> Deviation:
    """How far the joints are off where the rows say they are."""
    followed = timed.path.followed
    read = followed_as_read(timed, settled)
    time = np.unique(np.concatenate([read.joints.knots, timed.law.time]))
    u = np.interp(timed.law.at(time)[0], followed.joints.knots, followed.u)
    tcp = replace(timed.path.tcp, joints=read.joints)
    return deviation(tcp, orientation, read, (time, u))


def _rates_kept(checked: Checked, options: TimingOptions) -> bool:
    """Whether the limits of acceleration, and those of torque rate and jerk that somebody stated,
    are kept by the time law."""
    rates = [checked.acceleration_ratio]
    if options.rates_stated:
        rates += [checked.torque_rate_ratio, checked.jerk_ratio]
    return max(rates) <= 1 + 1e-9


def _acceleration_ratio(dynamics: PathDynamics, settled: Settled) -> float | None:
    """Of the rows as they are read, over the robot's own limits; None where it states none."""
    robot = dynamics.model.robot
    own = MotionLimits.of(robot).qdd_max
    if not np.isfinite(own).any():
        return None
    return settled.bounds.first(robot.n).acceleration_ratio(own)


def _note(
    dynamics: PathDynamics, checked: Checked, settled: Settled, kept: bool, options: TimingOptions
) -> str:
    """Why the bounds are not guaranteed; empty where they are."""
    bend = settled.bounds.acceleration_ratio(options.limits.qdd_max)
    bend = max(bend, checked.acceleration_ratio)
    if bend > 1 + 1e-9 and np.isfinite(bend):
        return (
            f"the acceleration of an axis reaches {bend:.3g} times its limit; plan with more rows "
            "(--rate), or lower the feed"
        )
    if dynamics.model.robot.weightless:
        return "no link of the robot file has mass, so the torques are not known"
    unbounded = np.isfinite(checked.torque_ratio) and not np.isfinite(checked.torque_rate_ratio)
    if unbounded and options.rates_stated:
        return SAMPLED_NOTE
    return guarantee_note(dynamics, options.certified, kept)
