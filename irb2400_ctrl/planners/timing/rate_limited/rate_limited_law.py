"""`RateLimitedLaw`: when the path is where, without a jump of the acceleration from rest to
rest."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.bernstein import linear
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_bounds import Checked, Peaks
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.cell_motion import (
    CellMotion,
    is_joined,
    refined_grid,
)
from irb2400_ctrl.planners.timing.rate_limited.hyperbolic_motion import arc, hyperbolic
from irb2400_ctrl.planners.timing.rate_limited.output_bounds import OutputRatios, output_ratios
from irb2400_ctrl.planners.timing.rate_limited.sampled_check import filled_by_samples
from irb2400_ctrl.planners.timing.time_law import TimeLaw

# how often cells are halved for the check, where a bound is above its limit or the largest
_HALVINGS = 3
# the law's numbers may disagree by rounding
_ROUNDING = 1e-11


@dataclass(frozen=True)
class RateLimitedLaw(TimeLaw):
    """s(t) with sddot = u continuous, linear in s between the grid points, and of constant jerk in
    the end cells.

    Inside a cell u = u_i + beta (s - s_i): a hyperbolic, or harmonic, motion in closed form. At an
    end u grows as the cube root of s, which no straight line follows: there s = h (t / T)^3 within
    the first cell, which asks for x_1 = 3 h u_1 / 2, and likewise backwards in the last one. There
    are three cells at least; x is zero at both ends.
    """

    u: Array
    """sddot at the grid points [m/s2], zero at both ends, shape (m + 1,); x_{i+1} - x_i = h (u_i +
    u_{i+1}) inside"""

    @cached_property
    def slope(self) -> Array:
        """beta = du/ds in each cell, shape (m,) [1/s2]; not used in the end cells."""
        return np.asarray(np.diff(self.u) / np.diff(self.s))

    @property
    def largest(self) -> Array:
        """Upper bound of sdot^2 in each cell, shape (m,)."""
        ends = np.maximum(self.x[:-1], self.x[1:])
        middle = self.x[:-1] + np.diff(self.s) * self.u[:-1]
        middle[[0, -1]] = 0.0
        return np.maximum(ends, middle)

    @cached_property
    def time(self) -> Array:
        """When the grid points are passed [s], shape (m + 1,)."""
        v = np.sqrt(self.x)
        h = np.diff(self.s)
        # h / (v_i + v_{i+1}) = tanh(omega dt / 2) / omega with omega^2 = beta, or tan for a
        # negative one
        half = h / (v[:-1] + v[1:])
        step = 2 * half * arc(self.slope * half**2)
        step[0] = 3 * h[0] / v[1]
        step[-1] = 3 * h[-1] / v[-2]
        return np.concatenate([[0.0], np.cumsum(step)])

    def on(self, s: Array) -> tuple[Array, Array]:
        """x and u at lengths between the end cells, or at the ends, shapes of s."""
        cell = np.clip(np.searchsorted(self.s, s, side="right") - 1, 1, len(self.s) - 3)
        d = s - self.s[cell]
        x = self.x[cell] + d * (2 * self.u[cell] + self.slope[cell] * d)
        at_end = (s <= self.s[0]) | (s >= self.s[-1])
        return np.where(at_end, 0.0, x), np.where(at_end, 0.0, self.u[cell] + self.slope[cell] * d)

    def slowed(self, factor: float) -> RateLimitedLaw:
        """The same motion that takes `factor` times as long."""
        return RateLimitedLaw(self.s, self.x / factor**2, self.u / factor**2)

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """(s, sdot, sddot) at the given times; before the start and after the end the path stands
        still."""
        inside = np.clip(time, 0.0, self.duration)
        last = len(self.s) - 2
        cell = np.clip(np.searchsorted(self.time, inside, side="right") - 1, 0, last)
        t = inside - self.time[cell]
        v = np.sqrt(self.x[cell])
        u = self.u[cell]
        beta = np.where((cell == 0) | (cell == last), 0.0, self.slope[cell])
        C, S1, S2 = hyperbolic(beta, t)
        s = self.s[cell] + v * S1 + u * S2
        speed = v * C + u * S1
        acceleration = u * C + beta * v * S1
        for end, sign, rest in ((0, 1.0, inside), (last, -1.0, self.duration - inside)):
            h = self.s[end + 1] - self.s[end]
            T = self.time[end + 1] - self.time[end]
            part = np.maximum(rest, 0.0) / T
            start = self.s[0] if end == 0 else self.s[-1]
            here = cell == end
            s = np.where(here, start + sign * h * part**3, s)
            speed = np.where(here, 3 * h / T * part**2, speed)
            acceleration = np.where(here, sign * 6 * h / T**2 * part, acceleration)
        over = (time >= self.duration) | (time < 0)
        s = np.clip(s, self.s[cell], self.s[cell + 1])
        return s, np.where(over, 0.0, np.maximum(speed, 0.0)), np.where(over, 0.0, acceleration)

    def sampled_ratios(
        self,
        path: JointPath,
        limits: MotionLimits,
        dynamics: PathDynamics,
        halvings: int,
        *,
        tight: bool = False,
    ) -> OutputRatios:
        """`ratios`, with infinite bounds of torques and their rates replaced by samples."""
        found = self.ratios(path, limits, dynamics, halvings, tight=tight)
        return filled_by_samples(found, self, path, limits, dynamics)

    def ratios(
        self,
        path: JointPath,
        limits: MotionLimits,
        dynamics: PathDynamics,
        halvings: int,
        *,
        tight: bool = False,
    ) -> OutputRatios:
        """Every constrained output over its limit, on cells that are halved, so often at most,
        where a bound is above a limit; tight: also where it is about the largest."""
        found = output_ratios(self.on_cells(refined_grid(self.s, path)), path, limits, dynamics)
        for _ in range(halvings):
            cut = found.to_cut(tight)
            if not cut.any():
                break
            motion = self.on_cells(divided(found.s, 1 + cut))
            if dynamics.local:
                parts, stretches = motion.taken(np.repeat(cut, 1 + cut), path)
                more = output_ratios(parts, stretches, limits, dynamics, whole=False)
                found = found.cut(cut, motion.s, more)
            else:
                found = output_ratios(motion, path, limits, dynamics)
        return found

    def bounds(self, path: JointPath, limits: MotionLimits, dynamics: PathDynamics) -> Checked:
        """Bounds over all times; inf where nothing can be said."""
        if not (self.is_consistent() and is_joined(path)):
            return Checked(np.inf, np.inf, (float(self.s[0]), 1), np.inf, np.inf, np.inf)
        ratios = self.ratios(path, limits, dynamics, _HALVINGS, tight=True)
        return ratios.checked(dynamics.n)

    def peaks(self, path: JointPath, limits: MotionLimits, dynamics: PathDynamics) -> Peaks:
        """Largest torque of each axis, and the largest torque rate, of samples where it has no
        bound."""
        n = dynamics.n
        ratios = self.sampled_ratios(path, limits, dynamics, 0)
        return Peaks(
            torque=ratios.value[:, :n].max(axis=0) * limits.tau_max,
            torque_rate_ratio=float(ratios.rate[:, :n].max()),
        )

    def is_consistent(self) -> bool:
        """Whether the numbers are those of one motion: x from u, rest at both ends."""
        h = np.diff(self.s)
        x = self.x
        u = self.u
        if not (len(h) > 2 and (h > 0).all() and np.isfinite(u).all() and (x[1:-1] > 0).all()):
            return False
        if x[[0, -1]].any() or u[[0, -1]].any():
            return False
        gained = h * (u[:-1] + u[1:])
        inner = np.abs(np.diff(x) - gained)[1:-1] <= _ROUNDING * (x[1:-2] + x[2:-1])
        at_ends = np.abs([x[1] - 1.5 * h[0] * u[1], x[-2] + 1.5 * h[-1] * u[-2]])
        return bool(inner.all() and (at_ends <= _ROUNDING * x[[1, -2]]).all())

    def on_cells(self, s: Array) -> CellMotion:
        """The motion on the parts of cells between the lengths s, the law's own grid included."""
        cell = np.clip(np.searchsorted(self.s, (s[:-1] + s[1:]) / 2) - 1, 0, len(self.s) - 2)
        slope = self.slope[cell]
        first = s[:-1] - self.s[cell]
        last = s[1:] - self.s[cell]
        width = last - first
        u = self.u[cell, None] + slope[:, None] * linear(first, last)
        x0 = self.x[cell] + first * (2 * self.u[cell] + slope * first)
        x = np.stack([x0, x0 + width * u[:, 0], x0 + width * (u[:, 0] + u[:, 1])], axis=1)
        h = np.diff(self.s)
        for end, near in ((0, 1), (-1, -2)):
            at_rest_first = self.u[[end, near]]
            x[end] = self.x[near]
            u[end] = at_rest_first if end == 0 else at_rest_first[::-1]
            slope[end] = 2 / 9 * self.x[near] / h[end] ** 2
        return CellMotion(s, x, u, slope)
