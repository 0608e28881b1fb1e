"""The one motion type: planners make it, controllers follow it, programs and logs give it back."""

from irb2400_ctrl.trajectory.file import load_trajectory, save_trajectory
from irb2400_ctrl.trajectory.trajectory import Trajectory, from_angles

__all__ = ["Trajectory", "from_angles", "load_trajectory", "save_trajectory"]
