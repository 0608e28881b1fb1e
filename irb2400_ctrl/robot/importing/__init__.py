"""Robots of other formats: a URDF, an MJCF or a table of DH parameters becomes a `Robot`."""

from irb2400_ctrl.robot.importing.chain_robot import Imported, Payload
from irb2400_ctrl.robot.importing.import_robot import import_robot

__all__ = ["Imported", "Payload", "import_robot"]
