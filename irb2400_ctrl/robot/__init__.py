"""The robot: its description, the file it is read from, and the formats it is written in."""

from irb2400_ctrl.robot.description import Robot
from irb2400_ctrl.robot.file import load_robot, robot_names, save_robot
from irb2400_ctrl.robot.identified import Identified
from irb2400_ctrl.robot.joint import Friction, Joint, Limits, MotorCoupling, Transmission
from irb2400_ctrl.robot.link import Body, Coupling, Link, ModifiedDH, Tool, Transform
from irb2400_ctrl.robot.outline import Outline, Part
from irb2400_ctrl.robot.shape import Box, Capsule, Cylinder, Shape, Sphere
from irb2400_ctrl.robot.uncertainty import BodyUncertainty, Uncertainty

__all__ = [
    "Body",
    "BodyUncertainty",
    "Box",
    "Capsule",
    "Coupling",
    "Cylinder",
    "Friction",
    "Identified",
    "Joint",
    "Limits",
    "Link",
    "ModifiedDH",
    "MotorCoupling",
    "Outline",
    "Part",
    "Robot",
    "Shape",
    "Sphere",
    "Tool",
    "Transform",
    "Transmission",
    "Uncertainty",
    "load_robot",
    "robot_names",
    "save_robot",
]
