"""Where to put a part: the pose of its work object that leaves the largest margins."""

from irb2400_ctrl.planners.placement.area import Area
from irb2400_ctrl.planners.placement.outlook import Outlook
from irb2400_ctrl.planners.placement.place import Placement, place
from irb2400_ctrl.planners.placement.proof import Proof
from irb2400_ctrl.planners.placement.rail_position import RailPosition, rail_position

__all__ = ["Area", "Outlook", "Placement", "Proof", "RailPosition", "place", "rail_position"]
