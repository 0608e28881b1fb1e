"""`JointPlan`: a certified motion of all joints from rest to rest, its TCP above a plane."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell import Scene
from irb2400_ctrl.planners.certify import certify_joints
from irb2400_ctrl.planners.clearance.clearance import unknown
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.linking.clearance_plane import ClearancePlane, spindle_axis
from irb2400_ctrl.planners.linking.raised_path import clearance_of, lowest, raised_path
from irb2400_ctrl.planners.plan_report import law_rows
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.rate_limited.rate_summary import rate_summary
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.timing.time_choices import fastest
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
    duration: float
    """[s]"""
    length: float
    """of the TCP's way [m]"""
    guaranteed: bool
    """the torque bound holds at every instant by construction, and was re-checked"""
    guarantee_note: str
    max_torque_ratio: float
    max_velocity_ratio: float
    """over all times"""
    lowest: float
    """height of the TCP over the clearance plane, a lower bound over all times [m]"""
    clearance: dict[str, Any] = field(default_factory=lambda: unknown("not asked for"))
    rates: dict[str, Any] = field(default_factory=dict)
    """both as of a `Plan`"""


def plan_joints(
    robot: Robot,
    q_from: Array,
    q_to: Array,
    plane: ClearancePlane,
    rate: float,
    timing: TimingOptions,
    scene: Scene | None = None,
) -> JointPlan:
    """The fastest motion along a line in joint space, or along a parabola where the line would
    bring the TCP below the clearance plane (or below its lower end, where that lies below).

    Args:
        q_from, q_to: configurations in the joint box [rad], shape (n,).
        plane: what the TCP stays above.
        rate: rows of the trajectory per second [1/s].
        timing: limits and back-end.
        scene: the arm in its cell.

    Raises:
        UnreachableError: no such parabola within the joint box, or (CollisionError) none that
            touches nothing.
        InfeasibleError: the torque limits leave no motion; says where.
    """
    dynamics = path_dynamics(robot)
    joints = raised_path(dynamics.model, q_from, q_to, plane, scene)
    tcp = TcpPath(dynamics.model, joints, spindle_axis(robot))
    first: TimeLaw = fastest(dynamics, joints, timing).law
    law = first
    rates: dict[str, Any] = {}
    if timing.limits.smooth:
        smooth = time_rate_limited(dynamics, joints, timing.limits, count=timing.cells // 2)
        law = smooth.law
        rates = rate_summary(smooth.law, joints, timing.limits, dynamics, first)
    bounds = certify_joints(dynamics, joints, law, timing)
    trajectory, _ = law_rows(dynamics, law, tcp, rate)
    return JointPlan(
        robot=robot,
        trajectory=trajectory,
        certificate=bounds.certificate,
        duration=law.duration,
        length=float(tcp.lengths[-1]),
        guaranteed=bounds.guaranteed,
        guarantee_note=bounds.note,
        max_torque_ratio=bounds.torque_ratio,
        max_velocity_ratio=bounds.velocity_ratio,
        lowest=lowest(tcp, plane),
        clearance=_clearance(scene, tcp),
        rates=rates,
    )


def _clearance(scene: Scene | None, tcp: TcpPath) -> dict[str, Any]:
    """The entry `clearance_mm`."""
    found = clearance_of(scene, tcp.joints)
    if found is None:
        return unknown("the robot file has no [outline], the space that the arm takes up")
    return found.summary(float(tcp.way(found.s)))
