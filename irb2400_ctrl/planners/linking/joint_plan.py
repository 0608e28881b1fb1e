"""`JointPlan`: a certified motion of all joints from rest to rest, its TCP above a plane."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.planners.certify import certify_joints
from irb2400_ctrl.planners.clearance.clearance import entry, unknown
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane
from irb2400_ctrl.planners.linking.raised_path import clearance_of, lowest, raised_path
from irb2400_ctrl.planners.plan_report import law_rows
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.path_timer import PathTimer
from irb2400_ctrl.planners.timing.sampled_reference import SampledReference
from irb2400_ctrl.planners.timing.sampled_reference.interpolation import Interpolation
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory


@dataclass(frozen=True)
class JointPlan:
    """What `plan_joints` found."""

    robot: Robot
    trajectory: Trajectory
    """at even times, at rest in the first and the last row"""
    certificate: Certificate
    """the joint path, its time law and the limits: checked again with `certificate.check`"""
    interpolation: Interpolation
    """how the controller reads the rows"""
    duration: float
    """[s]"""
    length: float
    """of the TCP's way [m]"""
    guaranteed: bool
    """the torque bound holds at every instant by construction, and was re-checked"""
    guarantee_note: str
    max_torque_ratio: float
    max_velocity_ratio: float
    max_acceleration_ratio: float | None
    """over all times; the last is None where the robot states no limit"""
    lowest: float
    """height of the TCP over the clearance plane, a lower bound over all times [m]"""
    clearance: dict[str, Any] = field(default_factory=lambda: unknown("not asked for"))
    """as of a `Plan`"""

    @property
    def reference(self) -> SampledReference:
        """The rows as the controller reads them."""
        return SampledReference(self.trajectory, self.interpolation)


def plan_joints(
    robot: Robot,
    q_from: Array,
    q_to: Array,
    plane: ClearancePlane,
    timing: TimingOptions,
    scene: Scene | None = None,
) -> JointPlan:
    """The fastest motion along a line in joint space, or along what `raised_path` finds where the
    line would bring the TCP below the clearance plane (or below its lower end, where that lies
    below), or the arm against something.

    Args:
        q_from, q_to: configurations in the joint box [rad], shape (n,).
        plane: what the TCP stays above.
        timing: limits, back-end and rows.
        scene: the arm in its cell.

    Raises:
        UnreachableError: no such path within the joint box, or (CollisionError) none that touches
            nothing.
        InfeasibleError: the torque limits leave no motion; says where.
    """
    dynamics = path_dynamics(robot)
    joints = raised_path(dynamics.model, q_from, q_to, plane, scene)
    tcp = TcpPath(dynamics.model, joints, robot.spindle_axis)
    knots = joints.knots
    followed = Followed(joints, np.arange(len(knots), dtype=float), 0.0, 0.0)
    task = TaskPath(followed, tcp, np.full(len(knots) - 1, np.inf))
    timer = PathTimer(dynamics, timing)
    settled = timer.settled(task, _timed(timer, task))
    bounds = certify_joints(dynamics, joints, settled, timing)
    trajectory, _ = law_rows(dynamics, settled.law, tcp, settled.reference)
    return JointPlan(
        robot=robot,
        trajectory=trajectory,
        certificate=bounds.certificate,
        interpolation=timing.sampling.interpolation,
        duration=settled.law.duration,
        length=float(tcp.lengths[-1]),
        guaranteed=bounds.guaranteed,
        guarantee_note=bounds.note,
        max_torque_ratio=bounds.torque_ratio,
        max_velocity_ratio=bounds.velocity_ratio,
        max_acceleration_ratio=bounds.acceleration_ratio,
        lowest=lowest(tcp, plane),
        clearance=entry(clearance_of(scene, joints), tcp.way),
    )


def _timed(timer: PathTimer, task: TaskPath) -> TimeLaw:
    """The fastest law, with the limits of torque rate and jerk where there are any."""
    first = timer.fastest(task)
    if not timer.options.limits.smooth:
        return first
    try:
        return timer.rate_limited(task)
    except InfeasiblePointError:
        if timer.options.rates_stated:
            raise
        # a torque that jumps by itself: the rows are slowed instead
        return first
