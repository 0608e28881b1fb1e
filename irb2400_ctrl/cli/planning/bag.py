"""`irb2400 path bag`: a motion as a ROS 2 bag."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from irb2400_ctrl.cli.options import OutOption, RobotOption, input_file, load_arm, output_folder
from irb2400_ctrl.cli.summary import Summary, answers, wrote

TrajectoryArgument = Annotated[
    Path, typer.Argument(metavar="TRAJECTORY", help="The trajectory.csv of a plan, or any other.")
]


@answers
def bag(trajectory: TrajectoryArgument, out: OutOption, robot: RobotOption = "irb2400") -> Summary:
    """Write a motion as a ROS 2 bag: /joint_trajectory for a controller, /joint_states for RViz ->
    trajectory.mcap."""
    input_file(trajectory, "a trajectory (CSV)")
    output_folder(out)

    from irb2400_ctrl.trajectory import load_trajectory
    from irb2400_ctrl.trajectory.ros_bag import names_in_bag, save_ros_bag

    arm = load_arm(robot)
    motion = load_trajectory(trajectory, arm.n)
    written = save_ros_bag(motion, arm.joint_names, out / "trajectory.mcap")
    names = names_in_bag(motion, arm.joint_names)
    print(f"{len(motion.time)} points of {', '.join(names)}, {motion.duration:.2f} s")
    facts = {"points": len(motion.time), "joints": names}
    return wrote({**facts, "duration_s": motion.duration}, [written])
