"""Programs for the robot's own controller."""

from irb2400_ctrl.planners.programs import egm, rapid

__all__ = ["egm", "rapid"]
