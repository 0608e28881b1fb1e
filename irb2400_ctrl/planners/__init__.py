"""Tool paths in, timed trajectories out: clear of singularities, within the torque limits.

from irb2400_ctrl.planners import plan_path
from irb2400_ctrl.planners import read_path
plan = plan_path(robot, read_path("part.apt"))
plan.write("out")
"""

from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.joint_move import JointMove, joint_move
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.linking.link_options import LinkOptions
from irb2400_ctrl.planners.linking.program_motion import ProgramMotion
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_path import plan_path
from irb2400_ctrl.planners.program_plan import ProgramPlan, plan_program
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions
from irb2400_ctrl.planners.programs.rapid.rapid_program import RapidProgram, rapid_program
from irb2400_ctrl.planners.programs.rapid.rapid_reader import read_rapid
from irb2400_ctrl.planners.timing.certificate import Certificate, check
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.planners.toolpath.cam_program import CamProgram, Operation
from irb2400_ctrl.planners.toolpath.positioner import Positioner, PositionerAxis, choose_settings
from irb2400_ctrl.planners.toolpath.read_path import read_path, read_program
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.planners.trajectory_optimisation.optimise_motion import optimise_motion
from irb2400_ctrl.planners.trajectory_optimisation.optimised import Optimised
from irb2400_ctrl.trajectory import Trajectory

__all__ = [
    "CamProgram",
    "Certificate",
    "Checked",
    "JointMove",
    "JointPath",
    "LinkOptions",
    "MotionLimits",
    "Operation",
    "Optimised",
    "Plan",
    "Positioner",
    "PositionerAxis",
    "ProgramMotion",
    "ProgramPlan",
    "RapidOptions",
    "RapidProgram",
    "ToolPath",
    "Trajectory",
    "builders",
    "check",
    "choose_settings",
    "joint_move",
    "optimise_motion",
    "path_dynamics",
    "plan_path",
    "plan_program",
    "rapid_program",
    "read_path",
    "read_program",
    "read_rapid",
    "time_joint_path",
]
