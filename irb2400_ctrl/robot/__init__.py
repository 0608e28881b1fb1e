"""The robot: its description, the file it is read from, and the formats it is written in."""

from irb2400_ctrl.robot.description import (
    Body,
    Coupling,
    Friction,
    Joint,
    Limits,
    Link,
    ModifiedDH,
    Robot,
    Tool,
    Transform,
)
from irb2400_ctrl.robot.file import load_robot, robot_names, save_robot

__all__ = [
    "Body",
    "Coupling",
    "Friction",
    "Joint",
    "Limits",
    "Link",
    "ModifiedDH",
    "Robot",
    "Tool",
    "Transform",
    "load_robot",
    "robot_names",
    "save_robot",
]
