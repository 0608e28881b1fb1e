"""An arm followed through its log as it comes: what is left of the torques, alarms,
suspicions, the numbers that drift."""

from irb2400_ctrl.watch.alarm import Alarm, Cusum, Usual
from irb2400_ctrl.watch.baseline import Baseline, Blocks
from irb2400_ctrl.watch.suspicion import Suspicion, followed
from irb2400_ctrl.watch.tracking import Tracked, Tracker
from irb2400_ctrl.watch.watch import Seen, Watch

__all__ = [
    "Alarm",
    "Baseline",
    "Blocks",
    "Cusum",
    "Seen",
    "Suspicion",
    "Tracked",
    "Tracker",
    "Usual",
    "Watch",
    "followed",
]
