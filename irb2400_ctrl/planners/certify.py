"""`certify`: what is sure of a timed tool path over all times, from its own numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.planners.enclosure.deviation import Deviation, deviation, singularity_margins
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.certificate import Certificate, check
from irb2400_ctrl.planners.timing.feed import feed_ratio
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.rate_limited.sampled_check import SAMPLED_NOTE
from irb2400_ctrl.planners.timing.sampled_timing import guarantee_note
from irb2400_ctrl.planners.timing.time_choices import TimedChoice
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.planners.toolpath.orientation import Orientation

# samples per second of a torque that has no bound, and seconds that are sampled at once
_RATE = 1e4
_SPAN = 10.0


@dataclass(frozen=True)
class JointBounds:
    """Upper bounds over a continuous motion of the joints, and whether they are guaranteed."""

    certificate: Certificate
    guaranteed: bool
    note: str
    """why the torque bound is not guaranteed; empty where it is"""
    torque_ratio: float
    """largest |tau| / tau_max; of samples where there is no bound"""
    velocity_ratio: float


@dataclass(frozen=True)
class PlanBounds:
    """Upper bounds over the continuous motion, and whether they are guaranteed."""

    certificate: Certificate
    guaranteed: bool
    note: str
    """why the torque bound is not guaranteed; empty where it is"""
    torque_ratio: float
    """largest |tau| / tau_max; of samples where there is no bound"""
    velocity_ratio: float
    feed_ratio: float | None
    """speed of the TCP over the feed; None without a feed"""
    deviation: Deviation
    singularity_margin: dict[str, float]
    """lower bounds of |sin q5| [-], |r| [m], |k| [m]"""


def certify(
    dynamics: PathDynamics,
    orientation: Orientation,
    timed: TimedChoice,
    options: TimingOptions,
) -> PlanBounds:
    """Bound everything that a plan promises, without the solver that found the motion."""
    path = timed.path
    joints = certify_joints(dynamics, path.joints, timed.law, options)
    return PlanBounds(
        certificate=joints.certificate,
        guaranteed=joints.guaranteed,
        note=joints.note,
        torque_ratio=joints.torque_ratio,
        velocity_ratio=joints.velocity_ratio,
        feed_ratio=feed_ratio(path.feed, timed.law),
        deviation=deviation(path.tcp, orientation, path.followed),
        singularity_margin=singularity_margins(dynamics.model, path.followed),
    )


def certify_joints(
    dynamics: PathDynamics, joints: JointPath, law: TimeLaw, options: TimingOptions
) -> JointBounds:
    """Bound torque and speed of a timed joint path, whatever its TCP does."""
    certificate = Certificate(joints, law, options.limits)
    checked = check(certificate, dynamics.model, dynamics)
    return JointBounds(
        certificate=certificate,
        guaranteed=options.certified and checked.holds(),
        note=_note(dynamics, checked, options.certified),
        torque_ratio=_torque_ratio(dynamics, certificate, checked),
        velocity_ratio=checked.velocity_ratio,
    )


def _note(dynamics: PathDynamics, checked: Checked, certified: bool) -> str:
    """Why the torque bound is not guaranteed; empty where it is."""
    if np.isfinite(checked.torque_ratio) and not np.isfinite(checked.torque_rate_ratio):
        return SAMPLED_NOTE
    return guarantee_note(dynamics, certified, checked.holds())


def _torque_ratio(dynamics: PathDynamics, certificate: Certificate, checked: Checked) -> float:
    """Largest |tau| / tau_max: the bound over all times, or, where there is none, the largest of
    10,000 samples per second."""
    if np.isfinite(checked.torque_ratio):
        return checked.torque_ratio
    law = certificate.law
    worst = 0.0
    for first in np.arange(0.0, law.duration, _SPAN):
        t = np.arange(first, min(first + _SPAN, law.duration), 1 / _RATE)
        _, q, qd, qdd = law.motion(certificate.path, t)
        tau = dynamics.torque(q, qd, qdd, t)
        worst = max(worst, float((np.abs(tau) / certificate.limits.tau_max).max()))
    return worst
