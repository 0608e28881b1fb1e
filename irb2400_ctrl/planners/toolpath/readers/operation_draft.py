"""An operation in the making."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.toolpath.cam_program import Event, Operation, Spindle, Tool
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

# places and axes nearer than this are one [m], [-]
SAME = 1e-7
FROM_ABOVE = (
    "rapid moves behind a change of tool are left out until a height is stated: the tool comes "
    "from above, not from the height of the one before"
)


@dataclass
class Draft:
    """What has been told of it; places in its frame."""

    name: str
    tool: Tool
    spindle: Spindle
    coolant: str
    frame: Array
    stated_frame: bool
    continues: bool = False
    """begins where the operation before ended"""
    position: list[Array] = field(default_factory=list)
    axis: list[Array] = field(default_factory=list)
    feed: list[float] = field(default_factory=list)
    rapid: list[bool] = field(default_factory=list)
    line: list[int] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    carried: int = 0
    """points at its start whose height is that of the tool before"""

    def begin_above(self) -> bool:
        """Leave out the points at the height of the tool before, where a rapid move to a stated
        height follows; whether there were such."""
        n = self.carried
        self.carried = 0
        if not 0 < n < len(self.position) - 1 or not self.rapid[n]:
            return False
        for rows in (self.position, self.axis, self.feed, self.rapid, self.line):
            del rows[:n]
        for event in self.events:
            if 0 <= event.point < n:
                self._happened(event)
        self.events = [replace(event, point=max(event.point - n, -1)) for event in self.events]
        return True

    def _happened(self, event: Event) -> None:
        """It comes before the first point now."""
        if event.kind == "coolant":
            self.coolant = event.text
        elif event.kind == "spindle":
            self.spindle = replace(self.spindle, speed=0.0)

    @property
    def moves(self) -> bool:
        """Whether its points and axes are not all one."""
        rows = np.hstack([self.position, self.axis]) if self.position else np.zeros((1, 6))
        return bool(np.ptp(rows, axis=0).max() > SAME)

    def finished(self, number: int, again: str, X: Array) -> Operation:
        """The operation with its points moved by X (4, 4); `again` tells equal names apart.

        Args:
            number: of the operation, from 1.
            again: added to its name.
            X: of the program's frame [m].
        """
        R = X[:3, :3]
        name = (self.name or f"operation {number}") + again
        path = ToolPath(
            np.array(self.position) @ R.T + X[:3, 3],
            np.array(self.axis) @ R.T,
            None,
            np.array(self.feed),
            name,
        )
        return Operation(
            number,
            name,
            path,
            np.array(self.rapid),
            np.array(self.line),
            self.tool,
            self.spindle,
            self.coolant,
            self.frame if self.stated_frame else None,
            tuple(self.events),
        )


def finished(drafts: list[Draft], default_name: str) -> tuple[Operation, ...]:
    """Operations numbered and named, all in the frame of the first of them."""
    seen: dict[str, int] = {}
    operations = []
    for number, draft in enumerate(drafts, 1):
        draft.name = draft.name or (default_name if len(drafts) == 1 else "")
        seen[draft.name] = seen.get(draft.name, 0) + 1
        again = f" ({seen[draft.name]})" if draft.name and seen[draft.name] > 1 else ""
        same = np.array_equal(draft.frame, drafts[0].frame)
        X = np.eye(4) if same else np.linalg.inv(drafts[0].frame) @ draft.frame
        operations.append(draft.finished(number, again, X))
    return tuple(operations)
