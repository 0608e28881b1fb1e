"""`SampledReference`: the rows of `trajectory.csv`, and the motion that is read between them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointMotion, JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.sampled_reference.interpolation import Interpolation
from irb2400_ctrl.planners.timing.sampled_reference.linear_columns import LinearColumns
from irb2400_ctrl.planners.timing.sampled_reference.reference_bounds import (
    ReferenceBounds,
    reference_bounds,
)
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.trajectory import Trajectory

_MOST_ROWS = 20_000_000


@dataclass(frozen=True, eq=False)
class SampledReference:
    """Rows at even times, and how a controller reads them."""

    rows: Trajectory
    interpolation: Interpolation

    @classmethod
    def of(
        cls,
        law: TimeLaw,
        path: JointPath,
        rate: float,
        interpolation: Interpolation,
        before: float = 0.0,
    ) -> SampledReference:
        """Rows at k / rate [s] up to the first one at or after the end of a timed path.

        Args:
            law, path: the timed path.
            rate: rows per second [1/s].
            interpolation: how they are read.
            before: how long the first row is before the start [s].

        Raises:
            InputError: too many rows.
        """
        count = int(np.ceil((law.duration + before) * rate - 1e-9)) + 1
        if count > _MOST_ROWS:
            raise InputError(
                f"rate: {rate} rows per second make {count} rows; expected a lower rate"
            )
        time = np.arange(max(count, 2)) / rate - before
        _, q, qd, qdd = law.motion(path, time)
        return cls(Trajectory(time, q, qd, qdd, check_speeds=False), interpolation)

    def as_written(self, lengths: tuple[int, ...] = ()) -> SampledReference:
        """The same with the digits that the file keeps; `lengths`: columns of rails."""
        rows = self.rows
        if rows.lengths != lengths:
            rows = replace(rows, lengths=lengths, check_speeds=False)
        return replace(self, rows=rows.as_written())

    @property
    def motion(self) -> JointMotion:
        """Angles, speeds and accelerations over the time, as the controller has them."""
        rows = self.rows
        if self.interpolation == "linear":
            return LinearColumns.of(rows.time, rows.q, rows.qd, rows.qdd)
        return self.places

    @property
    def places(self) -> JointPath:
        """Where the joints are over the time."""
        rows = self.rows
        if self.interpolation == "linear":
            return JointPath.straight(rows.time, rows.q)
        return JointPath.hermite(rows.time, rows.q, rows.qd)

    def bounds(self, dynamics: PathDynamics, limits: MotionLimits) -> ReferenceBounds:
        """Torque, speed and acceleration over all times, from the rows alone."""
        found = reference_bounds(dynamics, self.motion, limits)
        if self.interpolation == "cubic":
            return self._with_column(found, limits)
        # straight between rows the joints are as fast as their angles say, too
        places = self.places
        slope = np.abs(places((found.time[:-1] + found.time[1:]) / 2, 1))
        return replace(found, speed=np.maximum(found.speed, slope))

    def _with_column(self, found: ReferenceBounds, limits: MotionLimits) -> ReferenceBounds:
        """The same with the column of accelerations: cubics do not read it, a feed-forward does."""
        if not np.isfinite(limits.qdd_max).any():
            return found
        rows = self.rows
        size = np.abs(rows.qdd)
        after = np.searchsorted(rows.time, (found.time[:-1] + found.time[1:]) / 2)
        column = np.maximum(size[after - 1], size[np.minimum(after, len(size) - 1)])
        return replace(found, acceleration=np.maximum(found.acceleration, column))

    def states(self, time: Array) -> tuple[Array, Array, Array]:
        """q, qd, qdd at any times (k,), each (k, n)."""
        motion = self.motion
        return motion(time), motion(time, 1), motion(time, 2)
