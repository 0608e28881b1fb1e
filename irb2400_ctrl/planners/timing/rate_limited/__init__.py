"""Time laws without a jump of torque or acceleration."""

from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw

__all__ = ["RateLimitedLaw"]
