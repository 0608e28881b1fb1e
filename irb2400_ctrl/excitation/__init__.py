"""Motions that tell effects apart which an ordinary motion does not."""

from irb2400_ctrl.excitation.excitation import Excitation
from irb2400_ctrl.excitation.excite import excite, separability
from irb2400_ctrl.excitation.groups import AmbiguityGroup, groups
from irb2400_ctrl.excitation.motion_design import Budget
from irb2400_ctrl.excitation.pair_separability import Separability

__all__ = [
    "AmbiguityGroup",
    "Budget",
    "Excitation",
    "Separability",
    "excite",
    "groups",
    "separability",
]
