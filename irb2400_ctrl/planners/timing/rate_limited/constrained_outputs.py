"""`ConstrainedOutputs`: everything along a path whose value and rate of change have limits,
enclosed cell by cell.

An output is  y = a(s) u + b(s) x + e(s) sqrt(x) + c(s) + dry friction: the torque of each axis,
and, with a = q', b = q'', its acceleration. Its rate of change, dry friction apart, is with u' =
du/ds

    dy/dt = sqrt(x) [(a' + 2 b) u + a u' + b' x + c'] + e u + e' x.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits


@dataclass(frozen=True)
class ConstrainedOutputs:
    """k outputs on m cells; parabolas as Bernstein coefficients of degree 2 (second axis)."""

    h: Array
    """lengths of the cells [m], shape (m,)"""
    a: Array
    b: Array
    e: Array
    c_high: Array
    c_low: Array
    """shape (m, 3, k)"""
    remainder: Array
    """bounds of the distance of a, b, e, c from their parabolas, shape (4, m, k)"""
    slow: Array
    """smallest |q'| in the cell, where friction is highest, shape (m, k)"""
    forwards: Mask
    backwards: Mask
    friction: Array
    """F_s, F_c, F_v, omega_st of eq. 54, shape (4, m, k); no friction, and omega_st = inf, where
    the output is an acceleration"""
    limit: Array
    """of |y|, shape (m, k)"""
    rate: Array
    """of |dy/dt|, shape (m, k); inf, like the limit, where there is none"""
    axis: Integers
    """number 1… of the axis, shape (m, k)"""

    @classmethod
    def of(cls, cells: Cells, limits: MotionLimits, friction: Array) -> ConstrainedOutputs:
        """The torques of an enclosed path, then the accelerations of joints where they or their
        rates are limited."""
        m, _, n = cells.a.shape
        none = np.full(n, np.inf)
        rate = none if limits.torque_rate is None else limits.torque_rate
        jerk = none if limits.jerk is None else limits.jerk
        # all joints first as torques, then as accelerations without anything but a and b
        zero = np.zeros((m, n))
        zeros = np.zeros((m, 3, n))
        pairs: tuple[tuple[Any, Any], ...] = (
            (cells.a, cells.speed),
            (cells.b, bernstein.raised(cells.curvature, 2)),
            (cells.e, zeros),
            (cells.c_high, zeros),
            (cells.c_low, zeros),
            (cells.remainder, np.zeros((4, m, n))),
            (bernstein.least_size(cells.speed), zero),
            (cells.forwards, zero.astype(bool)),
            (cells.backwards, zero.astype(bool)),
            (
                _rows(list(friction.T), m),
                _rows([0, 0, 0, none], m, n),
            ),
            (_rows([limits.tau_max], m)[0], _rows([limits.qdd_max], m)[0]),
            (_rows([rate], m)[0], _rows([jerk], m)[0]),
            2 * (np.broadcast_to(np.arange(1, n + 1), (m, n)),),
        )
        wanted = np.flatnonzero(limits.bounds_bend)
        parts: list[Any] = [
            np.concatenate([torque, motion[..., wanted]], axis=-1) for torque, motion in pairs
        ]
        return cls(cells.h, *parts)

    @property
    def count(self) -> int:
        """Number of outputs."""
        return int(self.limit.shape[1])

    def dry_friction(self, x: Array) -> tuple[Array, Array]:
        """Least and largest dry friction in each cell that is passed with sdot^2 >= x (m, 1),
        shapes (m, k)."""
        law = FrictionLaw(*self.friction)
        return law.dry_range(self.slow**2 * x, self.forwards, self.backwards)

    def building_up(self, x: Array) -> tuple[Array, Array]:
        """Path jerk within the rates [m/s3], and how long it acts until a limit, or x, is reached
        [s]; each (m,)."""
        a = np.maximum(bernstein.largest_size(self.a), 1e-12)
        jerk = (self.rate / a).min(axis=1)
        return jerk, np.minimum((self.limit / a).min(axis=1) / jerk, np.sqrt(np.sqrt(x) / jerk))


def _rows(values: list[Array | int], m: int, n: int | None = None) -> Array:
    """Numbers per joint, the same in every cell, shape (len(values), m, n)."""
    width = len(np.atleast_1d(values[0])) if n is None else n
    return np.stack([np.broadcast_to(np.asarray(v, dtype=float), (m, width)) for v in values])
