"""Constraints  p u + q x_i <= r  that keep a motion within its torque and acceleration limits all
over every cell.

In a cell u is constant and x(t) = x_i + 2 h u t, 0 <= t <= 1. With parabolas for the coefficients
the torque is a cubic in t whose Bernstein coefficients are linear in (u, x_i); four coefficients
below the limit keep the whole cubic below it. What does not fit is bounded by what does, each time
on the safe side:

    e sqrt(x), e > 0:   the tangent at x_bar lies above the root everywhere
    e sqrt(x), e < 0:   the chord x / sqrt(x_high) lies below the root up to x_high
    dry friction:       the Stribeck curve is highest at the slowest speed of the cell
    parabolas:          their remainder, times bounds of |u| and x that are constraints themselves
    other effects:      `effect_bounds`
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.enclosure.effect_bounds import Variant, load_cap, variants
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.torque_rows import has_machine_code, write_torque_rows

# room for rounding in the passes, as a part of the limit
ROUNDING = 1e-7
_Block = tuple[Array, Array, Array]
"""p, q and r of some constraints, each (m, …)"""


@dataclass(frozen=True)
class Linearisation:
    """Where the constraints touch what is not linear, per cell; shapes (m,)."""

    x_bar: Array
    """point of the tangent"""
    x_low: Array
    x_high: Array
    """bounds of x in the cell"""
    u_max: Array
    """bound of |u|; inf leaves the remainder of a out (a first guess, not safe)"""
    u_bar: Array
    """u expected: decides which sign a load has where its friction helps"""

    def part(self, of: slice) -> Linearisation:
        """Of some neighbouring cells."""
        return Linearisation(*(getattr(self, field.name)[of] for field in fields(self)))

    @property
    def bounds_u(self) -> bool:
        """Whether |u| has a bound in every cell."""
        return bool(np.isfinite(self.u_max).all())


def dry_friction(cells: Cells, friction: Array, x_low: Array) -> tuple[Array, Array]:
    """Least and largest dry friction in each cell that is passed with sdot^2 >= x_low (m,).

    Friction is (F_s, F_c, F_v, omega_st) per joint (eq. 54). Shapes (m, n) [Nm].

    Args:
        cells: the path enclosed cell by cell.
        friction: shape (n, 4) [Nm, Nm, Nm s/rad, rad/s].
        x_low: [m2/s2].
    """
    slowest = bernstein.least_size(cells.speed) ** 2 * x_low[:, None]
    law = FrictionLaw.of_table(friction)
    return law.dry_range(slowest, cells.forwards, cells.backwards)


@dataclass(frozen=True)
class TorqueConstraints:
    """The constraints of a path, each divided by its limit, made for some neighbouring cells when
    they are asked for: of all cells they are the largest array of a plan."""

    cells: Cells
    """the enclosed path"""
    limits: MotionLimits
    """of torque and acceleration"""
    friction: Array
    """table of eq. 54, shape (n, 4)"""
    at: Linearisation
    """where to linearise"""
    extra: Array | None = None
    """part of each torque limit to hold back, shape (m, 2, n): above, below [Nm]"""

    @property
    def blocks(self) -> list[slice]:
        """Cells to ask for at once; all where effects beside the regular form know the whole
        way."""
        m = len(self.cells.h)
        return bernstein.blocks(m) if self.cells.added is None else [slice(0, m)]

    def __getitem__(self, of: slice) -> Array:
        """Of neighbouring cells, shape (cells, k, 3)."""
        cells = self.cells.part(of)
        at = self.at.part(of)
        held = None if self.extra is None else self.extra[of]
        by_machine = cells.added is None and has_machine_code()
        blocks = _other_blocks(cells, self.limits, at)
        if not by_machine:
            blocks = _torque_blocks(cells, self.limits, self.friction, at, held) + blocks
        written = 8 * len(self.limits.tau_max) if by_machine else 0
        ends = np.cumsum([written, *(block[0][0].size for block in blocks)])
        table = np.empty((len(cells.h), ends[-1], 3))
        if by_machine:
            _write_torque(table, cells, self.limits, self.friction, at, held)
        for first, last, block in zip(ends, ends[1:], blocks, strict=False):
            for column, values in enumerate(block):
                table[:, first:last, column] = values.reshape(len(values), -1)
        return table


def torque_constraints(
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    at: Linearisation,
    extra: Array | None = None,
) -> Array:
    """All `TorqueConstraints`, shape (m, k, 3).

    Args:
        cells: the enclosed path, of m cells.
        limits: of torque and acceleration.
        friction: table of eq. 54, shape (n, 4).
        at: where to linearise.
        extra: part of each torque limit to hold back, shape (m, 2, n): above, below [Nm].
    """
    constraints = TorqueConstraints(cells, limits, friction, at, extra)
    return np.concatenate([constraints[block] for block in constraints.blocks])


def _other_blocks(cells: Cells, limits: MotionLimits, at: Linearisation) -> list[_Block]:
    """The constraints beside those of the torque."""
    blocks = _load_blocks(cells, limits.tau_max)
    blocks += _acceleration_blocks(cells, limits.qdd_max)
    if at.bounds_u:
        blocks += _bounds_of_u(at.u_max)
    return blocks


def _write_torque(
    table: Array,
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    at: Linearisation,
    extra: Array | None,
) -> None:
    """The rows of `_torque_blocks`, by machine code."""
    write_torque_rows(
        table,
        cells,
        (at.x_bar, at.x_high),
        dry_friction(cells, friction, at.x_low),
        _remainder(cells, at),
        np.zeros((len(cells.h), 2, len(friction))) if extra is None else extra,
        (limits.tau_max, 1 - ROUNDING),
    )


def _torque_blocks(
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    at: Linearisation,
    extra: Array | None,
) -> list[_Block]:
    """Torque of every joint below its limit and above its negative, one block for every combination
    of the effects."""
    bottom, top = dry_friction(cells, friction, at.x_low)
    remainder = _remainder(cells, at)
    nothing = np.zeros_like(top)
    held_above, held_below = (nothing, nothing) if extra is None else (extra[:, 0], extra[:, 1])
    box = (at.x_low, at.x_high, at.u_max)
    blocks = []
    for side, c, dry, held in (
        (1.0, cells.c_high, top, held_above),
        (-1.0, -cells.c_low, -bottom, held_below),
    ):
        plain = Variant(side * cells.a, side * cells.b, side * cells.e, c, nothing)
        parts = [plain]
        if cells.added is not None:
            bar = (at.u_bar, at.x_bar)
            parts = list(variants(cells.added, plain, side, bar, box, limits.tau_max))
        for part in parts:
            b, constant = _without_root(part, at)
            reserve = dry + remainder + part.rest + held
            blocks.append(_block(part.a, b, constant, cells.h, limits.tau_max, reserve))
    return blocks


def _without_root(part: Variant, at: Linearisation) -> tuple[Array, Array]:
    """b and c with e sqrt(x) taken in: by the tangent where it pushes, by the chord where it
    helps."""
    pushing = np.maximum(part.e, 0.0)
    helping = np.where((part.e <= 0).all(axis=1, keepdims=True), part.e, 0.0)
    root = np.sqrt(at.x_bar)[:, None, None]
    chord = 1 / np.sqrt(np.maximum(at.x_high, 1e-30))[:, None, None]
    b = part.b + pushing / (2 * root) + helping * chord
    return b, part.c + pushing * root / 2


def _remainder(cells: Cells, at: Linearisation) -> Array:
    """What the parabolas may miss of the torque, nothing where |u| has no bound, shape (m, n)."""
    if not at.bounds_u:
        return np.zeros_like(cells.speed[:, 0])
    x = at.x_high[:, None]
    r_a, r_b, r_e, r_c = cells.remainder
    return np.asarray(r_a * at.u_max[:, None] + r_b * x + r_e * np.sqrt(x) + r_c)


def _load_blocks(cells: Cells, tau_max: Array) -> list[_Block]:
    """Load of the transmissions below the cap that bounds its friction."""
    if cells.added is None or not cells.added.has_load:
        return []
    a, b, c = cells.added.load
    # a bound of the load that is none for most axes: divided by itself all the same
    cap = np.minimum(load_cap(cells.added, tau_max), 1e6 * tau_max)
    return [_block(side * a, side * b, side * c, cells.h, cap) for side in (1.0, -1.0)]


def _acceleration_blocks(cells: Cells, qdd_max: Array) -> list[_Block]:
    """Acceleration q'' x + q' u of the joints that have a limit of it."""
    bounded = np.flatnonzero(np.isfinite(qdd_max))
    if not len(bounded):
        return []
    b = bernstein.raised(cells.curvature[:, :, bounded], 2)
    a = cells.speed[:, :, bounded]
    zero = np.zeros_like(b)
    return [_block(side * a, side * b, zero, cells.h, qdd_max[bounded]) for side in (1.0, -1.0)]


def _bounds_of_u(u_max: Array) -> list[_Block]:
    """|u| <= u_max."""
    one = np.ones_like(u_max)
    zero = np.zeros_like(u_max)
    return [(one, zero, u_max), (-one, zero, u_max)]


def _block(
    a: Array, b: Array, c: Array, h: Array, limit: Array, reserve: Array | float = 0.0
) -> _Block:
    """a u + b x + c + reserve <= limit all over the cells, divided by the limit, each (m, 4,
    n)."""
    p, q, r = _bernstein_rows(a, b, c, h)
    held = reserve[:, None] if isinstance(reserve, np.ndarray) else reserve
    left = limit * (1 - ROUNDING) - r - held
    return p / limit, q / limit, left / limit


def _bernstein_rows(a: Array, b: Array, c: Array, h: Array) -> tuple[Array, Array, Array]:
    """Coefficients of degree 3 of a u + b (x + 2 h u t) + c, for parabolas a, b, c; each (m, 4,
    n)."""
    a3 = bernstein.raised(a, 3) + 2 * h[:, None, None] * bernstein.times_parameter(b)
    return a3, bernstein.raised(b, 3), bernstein.raised(c, 3)
