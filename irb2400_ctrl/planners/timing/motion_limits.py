"""Limits of a motion, and the speed they allow at the grid points of a path."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed


@typed
@dataclass(frozen=True)
class MotionLimits:
    """What the arm may do; all arrays of shape (n,)."""

    qd_max: Array
    """[rad/s]"""
    tau_max: Array
    """[Nm]"""
    qdd_max: Array
    """[rad/s2], inf where there is none"""
    torque_rate: Array | None = None
    """of the change of torque, dry friction apart [Nm/s]; None lets it jump"""
    jerk: Array | None = None
    """[rad/s3]; None lets the acceleration jump"""

    def __post_init__(self) -> None:
        for name in ("qd_max", "tau_max", "qdd_max", "torque_rate", "jerk"):
            value = getattr(self, name)
            if value is None:
                continue
            limit = numbers(name, value)
            if limit.shape != np.shape(self.qd_max) or not (limit > 0).all():
                raise InputError(
                    f"limits: found {name} = {value!r:.60}, expected a positive number for each "
                    "axis of the same arm"
                )

    def with_rates(self, torque_rate: ArrayLike | None, jerk: ArrayLike | None) -> MotionLimits:
        """The same with limits of torque rate [Nm/s] and jerk [rad/s3], for all axes or for each;
        inf is none.

        Raises:
            InputError: not positive, or not as many as there are axes.
        """
        found = {}
        for name, unit, value in (("torque_rate", "Nm/s", torque_rate), ("jerk", "rad/s3", jerk)):
            if value is None:
                continue
            limit = numbers(name, value)
            if limit.shape not in {(), self.tau_max.shape} or not (limit > 0).all():
                raise InputError(
                    f"{name}: found {limit.tolist()} {unit}, expected a positive number, or one "
                    "for each of the "
                    f"{len(self.tau_max)} axes"
                )
            found[name] = np.broadcast_to(limit, self.tau_max.shape)
        return replace(self, **found)

    def within(self, widest: MotionLimits) -> MotionLimits:
        """These limits, none of which may be wider than the robot's own.

        Raises:
            InputError: one is wider; says which axis, found and allowed.
        """
        for name, unit in (("qd_max", "rad/s"), ("tau_max", "Nm"), ("qdd_max", "rad/s2")):
            found = np.asarray(getattr(self, name), dtype=float)
            allowed = getattr(widest, name)
            if found.shape != allowed.shape:
                raise InputError(
                    f"limits: found {name} of shape {found.shape}, expected {allowed.shape}: one "
                    "value per axis"
                )
            wrong = found > allowed * (1 + 1e-9)
            if wrong.any():
                j = int(np.argmax(wrong))
                raise InputError(
                    f"limits: {name} of axis {j + 1} is {found[j]:g} {unit}, expected "
                    f"at most the robot's own {allowed[j]:g} {unit}; limits of a plan can only "
                    "be tighter: for a stronger arm change the robot file"
                )
        return self

    def no_faster(self, torque_rate: Array | None, jerk: Array | None) -> MotionLimits:
        """The same with rates that are no larger than these, either, each (n,); None is none."""
        return replace(
            self,
            torque_rate=_smaller(self.torque_rate, torque_rate),
            jerk=_smaller(self.jerk, jerk),
        )

    @property
    def bounds_bend(self) -> Mask:
        """Which axes have a limit of acceleration or jerk, shape (n,)."""
        jerk = np.inf if self.jerk is None else self.jerk
        return np.asarray(np.isfinite(self.qdd_max) | np.isfinite(jerk))

    @property
    def smooth(self) -> bool:
        """Whether the motion has to be one without jumps of the acceleration."""
        rates = [rate for rate in (self.torque_rate, self.jerk) if rate is not None]
        return any(bool(np.isfinite(rate).any()) for rate in rates)

    def with_external(self, axes: ExternalAxes, rate: float | None) -> MotionLimits:
        """The same with those of axes that carry the part, after the arm's: their acceleration
        stands where the arm has its torque, their jerk where it has the rate of that.

        Args:
            rate: largest change of an acceleration, as a part of its limit [1/s], of axes whose
                jerk is not limited; None lets it jump.
        """
        none = np.full(len(axes), np.inf)
        jerk = axes.jerk if rate is None else np.minimum(axes.jerk, rate * axes.acceleration)
        arm = np.full(len(self.tau_max), np.inf) if self.torque_rate is None else self.torque_rate
        return MotionLimits(
            qd_max=np.append(self.qd_max, axes.speed),
            tau_max=np.append(self.tau_max, axes.acceleration),
            qdd_max=np.append(self.qdd_max, none),
            torque_rate=np.append(arm, jerk),
            jerk=None if self.jerk is None else np.append(self.jerk, none),
        )

    def with_room(self, n: int, part: float) -> MotionLimits:
        """The same with that part of the limits of acceleration, which of what follows the first n
        axes stand where these have their torque."""
        return replace(
            self,
            tau_max=np.append(self.tau_max[:n], part * self.tau_max[n:]),
            qdd_max=part * self.qdd_max,
        )

    def first(self, n: int) -> MotionLimits:
        """Those of the first n axes."""
        rate = None if self.torque_rate is None else self.torque_rate[:n]
        jerk = None if self.jerk is None else self.jerk[:n]
        return MotionLimits(self.qd_max[:n], self.tau_max[:n], self.qdd_max[:n], rate, jerk)

    @classmethod
    @typed
    def of(cls, robot: Robot) -> MotionLimits:
        """The limits of a robot's description."""
        stated = [joint.limits for joint in robot.joints]
        bend = [limit.acceleration_deg_s2 for limit in stated]
        rate = [limit.torque_rate_Nm_s for limit in stated]
        return cls(
            robot.qd_max,
            robot.tau_max,
            np.array([np.inf if a is None else np.radians(a) for a in bend]),
            None if rate.count(None) == len(rate) else np.array([r or np.inf for r in rate]),
        )


def _smaller(a: Array | None, b: Array | None) -> Array | None:
    if a is None or b is None:
        return b if a is None else a
    return np.asarray(np.minimum(a, b))


def speed_bounds(cells: Cells, qd_max: Array, cell_bound: Array | None = None) -> Array:
    """Bounds of x = sdot^2 at the grid points that keep |q'| sqrt(x) <= qd_max all over the cells,
    shape (m + 1,).

    Between grid points x is linear and q'^2 of degree four: the bounds at the ends are lowered by
    what the Bernstein coefficients of their product show above the limit.

    Args:
        cells: the path, cell by cell.
        qd_max: speed limits [rad/s], shape (n,).
        cell_bound: a further bound of x within each cell (feed), shape (m,), or at both ends of
            each, shape (2, m).
    """
    speeds = (cells.speed[block] for block in bernstein.blocks(len(cells.h)))
    parts = [linear_bounds(bernstein.product(speed, speed) / qd_max**2) for speed in speeds]
    first, last = np.concatenate(parts, axis=1)
    if cell_bound is not None:
        further = np.broadcast_to(cell_bound, (2, len(first)))
        first = np.minimum(first, further[0])
        last = np.minimum(last, further[1])
    return np.asarray(np.minimum(np.append(first, np.inf), np.insert(last, 0, np.inf)))


def linear_bounds(G: Array) -> Array:
    """Bounds of x at both ends of the cells, (2, m), such that x, linear between them, keeps
    G x <= 1.

    Args:
        G: Bernstein coefficients of degree four of k quantities that are not negative, shape
            (m, 5, k).
    """
    # a joint that stands at one end would allow any speed there
    floor = np.maximum(1e-2 * bernstein.largest_size(G), 1e-12)
    first = 1 / np.maximum(G[:, 0], floor)
    last = 1 / np.maximum(G[:, 4], floor)
    found = bernstein.hull(bernstein.product(G, bernstein.linear(first, last)))[1]
    excess = np.maximum(found, 1.0)
    return np.stack([(first / excess).min(axis=1), (last / excess).min(axis=1)])
