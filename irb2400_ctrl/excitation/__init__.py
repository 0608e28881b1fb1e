"""Motions that tell effects apart which an ordinary motion does not."""

from irb2400_ctrl.excitation.excitation import Excitation
from irb2400_ctrl.excitation.excite import excite
from irb2400_ctrl.excitation.groups import AmbiguityGroup, groups
from irb2400_ctrl.excitation.identification_motion import (
    IdentificationMotion,
    excite_identification,
)
from irb2400_ctrl.excitation.motion_design import Budget
from irb2400_ctrl.excitation.pair_separability import Separability

__all__ = [
    "AmbiguityGroup",
    "Budget",
    "Excitation",
    "IdentificationMotion",
    "Separability",
    "excite",
    "excite_identification",
    "groups",
]
