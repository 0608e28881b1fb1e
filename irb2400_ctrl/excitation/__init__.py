"""Motions that tell effects apart which an ordinary motion does not."""

from irb2400_ctrl.excitation.excitation import Excitation, Separability
from irb2400_ctrl.excitation.excite import excite, separability
from irb2400_ctrl.excitation.groups import AmbiguityGroup, groups
from irb2400_ctrl.excitation.motion_design import Budget

__all__ = [
    "AmbiguityGroup",
    "Budget",
    "Excitation",
    "Separability",
    "excite",
    "groups",
    "separability",
]
