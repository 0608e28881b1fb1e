"""What the written files hold: every key of plan.json, findings.json, watch.json, placement.json,
every column of trajectory.csv, with its unit.

`irb2400 schema` prints them; the tests hold every such file they make against them.
"""

from irb2400_ctrl.formats.findings_file import FindingsFile
from irb2400_ctrl.formats.placement_file import PlacementFile
from irb2400_ctrl.formats.plan_file import PlanFile
from irb2400_ctrl.formats.trajectory_row import TrajectoryRow
from irb2400_ctrl.formats.watch_file import WatchFile

__all__ = ["FindingsFile", "PlacementFile", "PlanFile", "TrajectoryRow", "WatchFile"]
