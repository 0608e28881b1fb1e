"""Motions that tell effects apart which an ordinary motion does not."""

from irb2400_ctrl.excitation.design import Budget
from irb2400_ctrl.excitation.excite import excite, separability
from irb2400_ctrl.excitation.groups import Group, groups
from irb2400_ctrl.excitation.result import Excitation, Separability

__all__ = ["Budget", "Excitation", "Group", "Separability", "excite", "groups", "separability"]
