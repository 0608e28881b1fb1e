"""Which branch, and which rotation of the tool, a path is followed with."""

from irb2400_ctrl.planners.redundancy.choice import Choice
from irb2400_ctrl.planners.redundancy.choices import choices
from irb2400_ctrl.planners.redundancy.follow import Followed, JointTarget, follow
from irb2400_ctrl.planners.redundancy.ladder_graph import Ladder, LadderWay
from irb2400_ctrl.planners.redundancy.singularity_margins import COMFORTABLE, relative_margins
from irb2400_ctrl.planners.redundancy.wrist_passage import Passage
from irb2400_ctrl.planners.redundancy.wrist_remedies import Remedy

__all__ = [
    "COMFORTABLE",
    "Choice",
    "Followed",
    "JointTarget",
    "Ladder",
    "LadderWay",
    "Passage",
    "Remedy",
    "choices",
    "follow",
    "relative_margins",
]
