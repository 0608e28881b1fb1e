"""`Excerpt`: what is read between some of the rows of a motion, with the rows at any phase."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.grids import counted
from irb2400_ctrl.planners.joint_path import JointMotion, JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.linear_columns import LinearColumns
from irb2400_ctrl.planners.timing.sampled_reference.reference_bounds import (
    ReferenceBounds,
    reference_bounds,
)
from irb2400_ctrl.planners.timing.sampled_reference.sampling import Sampling
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_law import TimeLaw


@dataclass(frozen=True)
class Excerpt:
    """Intervals between rows, taken out of a motion and put one after another."""

    start: Array
    """times of the motion at which the intervals begin [s], shape (k,)"""
    motion: JointMotion
    """what the controller reads, over a time of its own: interval i from i to i + 1 over the
    rate"""
    places: JointPath

    @classmethod
    def of(
        cls, law: TimeLaw, path: JointPath, sampling: Sampling, spans: Array, phase: float
    ) -> Excerpt:
        """The intervals that touch spans of time (m, 2) [s], rows at (k + phase) / rate."""
        first = np.floor(spans[:, 0] * sampling.rate - phase).astype(int)
        count = np.ceil(spans[:, 1] * sampling.rate - phase).astype(int) - first
        number = np.unique(np.repeat(first, count) + counted(count)).astype(float)
        start = (number + phase) / sampling.rate
        _, *a = law.motion(path, start)
        _, *b = law.motion(path, (number + 1 + phase) / sampling.rate)
        time = np.arange(len(number) + 1) / sampling.rate
        if sampling.interpolation == "linear":
            lines = [JointPath.lines(time, c, d) for c, d in zip(a, b, strict=True)]
            return cls(start, LinearColumns((lines[0], lines[1], lines[2])), lines[0])
        places = JointPath.joining(time, (a[0], a[1]), (b[0], b[1]))
        return cls(start, places, places)

    def bounds(self, dynamics: PathDynamics, limits: MotionLimits) -> ReferenceBounds:
        """Of torque and speed."""
        return reference_bounds(dynamics, self.motion, limits)

    def feed(self, task: TaskPath, law: TimeLaw) -> tuple[Array, Array]:
        """Speed of the TCP over the feed between the rows, with the ends of the intervals."""
        time = self.places.knots
        speed = replace(task.tcp, joints=self.places).largest_velocity(time)
        s = law.at(self.start + np.diff(time) / 2)[0]
        return time, speed / task.programmed_feed[task.joints.piece(s)]
