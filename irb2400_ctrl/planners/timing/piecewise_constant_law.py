"""`PiecewiseConstantLaw`: the time-optimal kind; sddot is constant between grid points and jumps
there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.cells import at_once, enclose
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_bounds import Checked, Peaks
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.torque_bounds import (
    acceleration_ratio,
    squared_speed_ratio,
    torque_bounds,
)

# parts that each cell is cut into for the check; more, while a bound is above the limit
_PARTS = (2, 4, 8)
# points that are added to a grid stay this part of its usual cell away from others
_SLIVER = 1e-3


@dataclass(frozen=True)
class PiecewiseConstantLaw(TimeLaw):
    """s(t) with sdot^2 = x linear in s between the grid points."""

    @cached_property
    def u(self) -> Array:
        """sddot in each cell [m/s2], shape (m,)."""
        return np.asarray(np.diff(self.x) / (2 * np.diff(self.s)))

    @property
    def largest(self) -> Array:
        """Largest sdot^2 in each cell, shape (m,)."""
        return np.maximum(self.x[:-1], self.x[1:])

    @cached_property
    def time(self) -> Array:
        """When the grid points are passed [s], shape (m + 1,)."""
        v = np.sqrt(self.x)
        with np.errstate(divide="ignore"):
            step = 2 * np.diff(self.s) / (v[:-1] + v[1:])
        return np.concatenate([[0.0], np.cumsum(step)])

    def on(self, s: Array) -> tuple[Array, Array]:
        """x and u at lengths s, shapes of s; u of the cell that begins at a grid point."""
        last = len(self.u) - 1
        cell = np.clip(np.searchsorted(self.s, s, side="right") - 1, 0, last)
        return np.interp(s, self.s, self.x), self.u[cell]

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """(s, sdot, sddot) at the given times; before the start and after the end the path stands
        still."""
        inside = np.clip(time, 0.0, self.duration)
        cell = np.clip(np.searchsorted(self.time, inside, side="right") - 1, 0, len(self.u) - 1)
        dt = inside - self.time[cell]
        v = np.sqrt(self.x[cell])
        u = self.u[cell]
        s = np.minimum(self.s[cell] + dt * (v + dt * u / 2), self.s[cell + 1])
        speed = np.maximum(v + dt * u, 0.0)
        over = (time >= self.duration) | (time < 0)
        return s, np.where(over, 0.0, speed), np.where(over, 0.0, u)

    def slowed(self, factor: float) -> PiecewiseConstantLaw:
        """The same motion that takes `factor` times as long."""
        return PiecewiseConstantLaw(self.s, self.x / factor**2)

    def slowed_at(self, time: Array, factor: Array) -> PiecewiseConstantLaw:
        """The same motion, `factor` (k,) times slower at the times (k,) of this one [s], and in
        between by straight lines; 1 is as it is.

        The factor changes little from time to time and not near the ends, where there is no speed.
        """
        s, slower = self._parted(time, factor)
        return PiecewiseConstantLaw(s, np.interp(s, self.s, self.x) / slower**2)

    def _parted(self, time: Array, factor: Array) -> tuple[Array, Array]:
        """The grid with what is passed at the times added wherever the factor is not 1, and the
        factor on it, each (k,)."""
        slow = factor > 1
        around = slow | np.append(slow[1:], False) | np.insert(slow[:-1], 0, False)
        inside = time[around & (time > 0) & (time < self.duration)]
        s = np.concatenate([self.s, self.at(inside)[0]])
        passed = np.concatenate([self.time, inside])
        order = np.argsort(s, kind="stable")
        own = order < len(self.s)
        s = s[order]
        gap = np.diff(s, prepend=-np.inf)
        # a point that is added keeps away from those of the grid
        far = np.minimum(gap, np.append(gap[1:], np.inf)) > _SLIVER * np.median(np.diff(self.s))
        kept = order[own | far]
        return s[own | far], np.interp(passed[kept], time, factor)

    def bounds(self, path: JointPath, limits: MotionLimits, dynamics: PathDynamics) -> Checked:
        """Torque, speed and acceleration cell by cell, from u and x alone.

        In a cell u is a number, x(t) is linear, and tau is a cubic with known Bernstein
        coefficients plus friction at known speeds plus a bounded remainder. The cells are parts of
        the law's own: sharper, and no linearisation of a solver is used again.
        """
        friction = dynamics.friction
        for parts in _PARTS:
            s, x = (divided(grid, np.full(len(self.u), parts)) for grid in (self.s, self.x))
            u = np.repeat(self.u, parts)
            ratio = np.empty((len(u), len(limits.tau_max)))
            speed = 0.0
            bend = 0.0
            # not all at once: of a long path they would be the largest arrays of its plan
            for part in at_once(dynamics, s):
                ends = slice(part.start, part.stop + 1)
                cells = enclose(dynamics, path, s[ends])
                above, below = torque_bounds(cells, u[part], x[ends], friction)
                ratio[part] = np.maximum(above, -below) / limits.tau_max
                squared = squared_speed_ratio(cells, x[ends], limits.qd_max)
                speed = max(speed, float(np.sqrt(squared.max())))
                bend = max(bend, acceleration_ratio(cells, u[part], x[ends], limits.qdd_max))
            if ratio.max() <= 1:
                break
        if dynamics.irregular or not np.isfinite(ratio).all():
            ratio = np.full_like(ratio, np.inf)
        cell, axis = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
        return Checked(
            torque_ratio=float(ratio[cell, axis]),
            velocity_ratio=speed,
            torque_at=(float(s[cell]), int(axis) + 1),
            acceleration_ratio=bend,
        )

    def peaks(self, path: JointPath, limits: MotionLimits, dynamics: PathDynamics) -> Peaks:
        """Largest torque of each axis; the acceleration jumps, so no torque rate is claimed."""
        cells = enclose(dynamics, path, self.s)
        above, below = torque_bounds(cells, self.u, self.x, dynamics.friction)
        return Peaks(torque=np.maximum(above, -below).max(axis=0), torque_rate_ratio=0.0)
