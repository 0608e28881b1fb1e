"""`TaskPath`: a joint path together with what its TCP does and the feed asked of it."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.feed import feed_bound, feed_ratios, programmed_feed
from irb2400_ctrl.planners.timing.time_joint_path import FeedBound
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.toolpath.orientation import Orientation


@dataclass(frozen=True, eq=False)
class TaskPath:
    """One way to follow a tool path: made once, and carried along to timing, check and report."""

    followed: Followed
    tcp: TcpPath
    programmed_feed: Array
    """on every piece of the joint path [m/s], shape (m,); inf where there is none"""

    @classmethod
    def of(cls, model: Model, orientation: Orientation, followed: Followed) -> TaskPath:
        """The TCP and the feed along followed joints."""
        tcp = TcpPath(model, followed.joints, orientation.spindle, orientation.carried)
        return cls(followed, tcp, programmed_feed(orientation, followed))

    @property
    def feed(self) -> FeedBound:
        """Bound of x = sdot^2 in cells of the joint path."""
        return feed_bound(self.tcp, self.programmed_feed)

    def feed_ratios(self, law: TimeLaw, places: JointPath) -> tuple[Array, Array] | None:
        """Speed of the TCP over the feed, see `feed.feed_ratios`."""
        return feed_ratios(self.tcp, self.programmed_feed, law, places)

    @property
    def joints(self) -> JointPath:
        """The joint path."""
        return self.followed.joints
