"""The symbolic model of the arm: kinematics, dynamics, friction, singularities."""

from irb2400_ctrl.model.model import Model

__all__ = ["Model"]
