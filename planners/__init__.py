"""Tool paths in, timed trajectories out: clear of singularities, within the torque limits.

from irb2400_ctrl.planners import plan_path, read_path
plan = plan_path(robot, read_path("part.apt"))
plan.write("out")
"""

from irb2400_ctrl.planners.certificate import Certificate, Checked, check
from irb2400_ctrl.planners.limits import MotionLimits
from irb2400_ctrl.planners.plan import Plan, Trajectory
from irb2400_ctrl.planners.plan_path import plan_path
from irb2400_ctrl.planners.read_path import read_path
from irb2400_ctrl.planners.toolpath import ToolPath

__all__ = [
    "Certificate",
    "Checked",
    "MotionLimits",
    "Plan",
    "ToolPath",
    "Trajectory",
    "check",
    "plan_path",
    "read_path",
]
