"""An operation in the making."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.toolpath.cam_program import Event, Operation, Spindle, Tool
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath

Array = npt.NDArray[np.float64]


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

    def finished(self, number: int, again: str, X: Array) -> Operation:
        """The operation with its points moved by X (4, 4); `again` tells equal names apart."""
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
