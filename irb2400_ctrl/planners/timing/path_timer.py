"""`PathTimer`: the time laws of paths of one arm under the same limits, and their rows."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.planners.enclosure.cells import enclose, grid
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_law import RateLimitedLaw
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.timing.sampled_reference.settled_reference import (
    Settled,
    settled_reference,
)
from irb2400_ctrl.planners.timing.sampled_timing import time_with_samples
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.timing_options import TimingOptions

_SHORT = 300
"""knots of a path of which both laws are made"""
# cubics through angles and speeds swing above an acceleration between two limits by up to 2/3
_ROOM_FOR_ROWS = 0.6


@dataclass(frozen=True)
class PathTimer:
    """What times a path: the arm's torque along it, limits and back-end."""

    dynamics: PathDynamics
    options: TimingOptions

    def fastest(self, path: TaskPath) -> TimeLaw:
        """The fastest law of the back-end, or of the timing for effects that have no bound.

        Raises:
            InfeasibleError: no motion within the limits; says where.
        """
        dynamics = self.dynamics
        options = self.options
        joints = path.joints
        limits = options.limits
        if options.certified and not dynamics.irregular:
            return time_joint_path(dynamics, joints, limits, count=options.cells, feed=path.feed)[0]
        s = grid(joints, options.cells)
        cells = enclose(dynamics, joints, s)
        friction = dynamics.friction
        if options.certified:
            return time_with_samples(dynamics, joints, cells, limits, friction, path.feed(s))
        # toppra takes seconds to import
        from irb2400_ctrl.planners.timing.toppra_timing import time_with_toppra

        return time_with_toppra(cells, limits, friction, path.feed(s))

    def rate_limited(self, path: TaskPath) -> RateLimitedLaw:
        """The fastest law with limits of torque rate and jerk, too.

        Raises:
            InfeasiblePointError: there is none; says where.
        """
        return time_rate_limited(
            self.dynamics,
            path.joints,
            self.options.limits,
            count=max(self.options.cells // 2, 50),
            feed=path.feed,
            sampling=self.options.sampling,
            feed_ratios=path.feed_ratios,
        )

    def settled(self, path: TaskPath, law: TimeLaw) -> Settled:
        """The rows of a law, slowed by what they swing above the limits, or of one that leaves room
        for them; of a short path the shorter of both, as a few rows that are slowed may cost less
        than the room. With toppra's timing as they are."""
        limits = self.options.limits
        room = self.roomy(path, law)
        found = self._rows(path, room)
        if room is law or len(path.joints.knots) > _SHORT:
            return found
        other = self._rows(path, law)
        keeps = other.worst(limits) <= max(1.0, found.worst(limits))
        return other if keeps and other.law.duration < found.law.duration else found

    def _rows(self, path: TaskPath, law: TimeLaw) -> Settled:
        options = self.options
        return settled_reference(
            self.dynamics, path, law, options.limits, options.sampling, options.certified
        )

    def roomy(self, path: TaskPath, law: TimeLaw) -> TimeLaw:
        """The law, or one that leaves room for the rows where its acceleration may jump, and axes
        that carry the part, or those of the arm, have a limit of it: they are too weak to be slowed
        around a few rows."""
        options = self.options
        limits = options.limits
        swings = options.sampling.interpolation == "cubic" and np.isfinite(limits.qdd_max).any()
        jumps = options.certified and isinstance(law, PiecewiseConstantLaw)
        if not (jumps and (self.dynamics.external or swings)):
            return law
        kept = limits.with_room(self.dynamics.model.robot.n, _ROOM_FOR_ROWS)
        return replace(self, options=replace(options, limits=kept)).fastest(path)
