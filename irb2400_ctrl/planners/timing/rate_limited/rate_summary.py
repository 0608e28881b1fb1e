"""What `plan.json` says of a motion with limits of torque rate or jerk."""

from __future__ import annotations

from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import HALVINGS
from irb2400_ctrl.planners.timing.time_law import TimeLaw


def rate_summary(
    law: RateLimitedLaw,
    path: JointPath,
    limits: MotionLimits,
    dynamics: PathDynamics,
    fastest: TimeLaw,
) -> dict[str, Any]:
    """Limits and upper bounds of torque rate and jerk per axis, and the duration without them.

    Args:
        law: that is summarised.
        path: the joints over the length s [m].
        limits: of torque [Nm], speed and acceleration, and of their rates.
        dynamics: the arm's torque along the path.
        fastest: the law without limits of the rates.
    """
    n = dynamics.n
    arm = slice(dynamics.model.robot.n)
    ratios = law.sampled_ratios(path, limits, dynamics, HALVINGS, tight=True)
    most = ratios.rate.max(axis=0)
    found: dict[str, Any] = {"duration_without_rates_s": fastest.duration}
    if limits.torque_rate is not None:
        found["torque_rate_limit_Nm_s"] = _listed(limits.torque_rate[arm])
        found["max_torque_rate_Nm_s"] = _listed(limits.torque_rate[arm], most[arm])
    if limits.jerk is not None:
        ratio = np.zeros(n)
        ratio[limits.bounds_bend] = most[n:]
        found["jerk_limit_deg_s3"] = _listed(np.degrees(limits.jerk[arm]))
        found["max_jerk_deg_s3"] = _listed(np.degrees(limits.jerk[arm]), ratio[arm])
    return found


def _listed(limits: Array, ratio: Array | None = None) -> list[float | None]:
    """Numbers per axis, limits times ratio; None where there is no limit."""
    part = np.ones_like(limits) if ratio is None else ratio
    return [float(f * v) if np.isfinite(v) else None for f, v in zip(part, limits, strict=True)]
