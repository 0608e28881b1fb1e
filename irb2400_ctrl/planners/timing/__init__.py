"""When a path is where: the fastest law within the limits, and the certificate that it is."""

from irb2400_ctrl.planners.timing.certificate import Certificate, check
from irb2400_ctrl.planners.timing.infeasible_point import InfeasiblePointError
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw

__all__ = [
    "Certificate",
    "Checked",
    "InfeasiblePointError",
    "MotionLimits",
    "RateLimitedLaw",
    "TimeLaw",
    "check",
    "time_joint_path",
    "time_rate_limited",
]
