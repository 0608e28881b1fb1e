"""Rows  p u + q x_i <= r  that keep a motion within its torque and acceleration limits all over
every cell.

In a cell u is constant and x(t) = x_i + 2 h u t, 0 <= t <= 1. With parabolas for the coefficients
the torque is a cubic in t whose Bernstein coefficients are linear in (u, x_i); four coefficients
below the limit keep the whole cubic below it. What does not fit is bounded by what does, each time
on the safe side:

    e sqrt(x), e > 0:   the tangent at x_bar lies above the root everywhere
    e sqrt(x), e < 0:   the chord x / sqrt(x_high) lies below the root up to x_high
    dry friction:       the Stribeck curve is highest at the slowest speed of the cell
    parabolas:          their remainder, times bounds of |u| and x that are rows themselves
    other effects:      `added_torque`
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.enclosure.effect_bounds import Variant, load_cap, variants
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits

Array = npt.NDArray[np.float64]

# room for rounding in the passes, as a part of the limit
ROUNDING = 1e-7


@dataclass(frozen=True)
class Linearisation:
    """Where the rows touch what is not linear, per cell; shapes (m,)."""

    x_bar: Array
    """point of the tangent"""
    x_low: Array
    x_high: Array
    """bounds of x in the cell"""
    u_max: Array
    """bound of |u|; inf leaves the remainder of a out (a first guess, not safe)"""
    u_bar: Array
    """u expected: decides which sign a load has where its friction helps"""


def dry_friction(cells: Cells, friction: Array, x_low: Array) -> tuple[Array, Array]:
    """Least and largest dry friction in each cell that is passed with sdot^2 >= x_low (m,).

    Friction is (F_s, F_c, F_v, omega_st) per joint (eq. 54). Shapes (m, n) [Nm].
    """
    slowest = bernstein.least_size(cells.speed) ** 2 * x_low[:, None]
    law = FrictionLaw.of_table(friction)
    return law.dry_range(slowest, cells.forwards, cells.backwards)


def torque_constraints(
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    at: Linearisation,
    extra: Array | None = None,
) -> Array:
    """All rows, shape (m, k, 3), each divided by its limit.

    Args:
        cells: the enclosed path.
        limits: torque and acceleration limits.
        friction: table of eq. 54, shape (n, 4).
        at: where to linearise.
        extra: part of each torque limit to hold back, shape (m, 2, n): above, below [Nm].
    """
    h = cells.h
    bottom, top = dry_friction(cells, friction, at.x_low)
    rest = np.zeros_like(top)
    if np.isfinite(at.u_max).all():
        X = at.x_high[:, None]
        r_a, r_b, r_e, r_c = cells.remainder
        rest = r_a * at.u_max[:, None] + r_b * X + r_e * np.sqrt(X) + r_c
    held = np.zeros((len(h), 2, top.shape[1])) if extra is None else extra
    rows = []
    nothing = np.zeros_like(top)
    for side, c, dry in ((1.0, cells.c_high, top), (-1.0, -cells.c_low, -bottom)):
        plain = Variant(side * cells.a, side * cells.b, side * cells.e, c, nothing)
        box = at.x_low, at.x_high, at.u_max
        for part in (
            [plain]
            if cells.added is None
            else variants(cells.added, plain, side, (at.u_bar, at.x_bar), box, limits.tau_max)
        ):
            pushing = np.maximum(part.e, 0.0)
            helping = np.where((part.e <= 0).all(axis=1, keepdims=True), part.e, 0.0)
            root = np.sqrt(at.x_bar)[:, None, None]
            chord = 1 / np.sqrt(np.maximum(at.x_high, 1e-30))[:, None, None]
            b = part.b + pushing / (2 * root) + helping * chord
            constant = part.c + pushing * root / 2
            p, q, r = _bernstein_rows(part.a, b, constant, h)
            limit = limits.tau_max
            reserve = (dry + rest + part.rest + held[:, 0 if side > 0 else 1])[:, None]
            rows.append(
                np.stack([p, q, limit * (1 - ROUNDING) - r - reserve], axis=-1) / limit[:, None]
            )
    if cells.added is not None and cells.added.has_load:
        a, b, c = cells.added.load
        # a bound of the load that is none for most axes: divided by itself all the same
        cap = np.minimum(load_cap(cells.added, limits.tau_max), 1e6 * limits.tau_max)
        for side in (1.0, -1.0):
            p, q, r = _bernstein_rows(side * a, side * b, side * c, h)
            rows.append(np.stack([p, q, cap * (1 - ROUNDING) - r], axis=-1) / cap[:, None])
    bounded = np.flatnonzero(np.isfinite(limits.qdd_max))
    if len(bounded):
        b = bernstein.raised(cells.curvature[:, :, bounded], 2)
        limit = limits.qdd_max[bounded]
        for side in (1.0, -1.0):
            p, q, r = _bernstein_rows(
                side * cells.speed[:, :, bounded], side * b, np.zeros_like(b), h
            )
            rows.append(np.stack([p, q, limit * (1 - ROUNDING) - r], axis=-1) / limit[:, None])
    m = len(h)
    table = [row.reshape(m, -1, 3) for row in rows]
    if np.isfinite(at.u_max).all():
        one = np.ones(m)
        zero = np.zeros(m)
        table.append(
            np.stack(
                [np.stack([one, zero, at.u_max], 1), np.stack([-one, zero, at.u_max], 1)], axis=1
            )
        )
    return np.concatenate(table, axis=1)


def _bernstein_rows(a: Array, b: Array, c: Array, h: Array) -> tuple[Array, Array, Array]:
    """Coefficients of degree 3 of a u + b (x + 2 h u t) + c, for parabolas a, b, c; each (m, 4,
    n)."""
    a3 = bernstein.raised(a, 3) + 2 * h[:, None, None] * bernstein.times_parameter(b)
    return a3, bernstein.raised(b, 3), bernstein.raised(c, 3)
