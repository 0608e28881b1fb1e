"""Bounds of torque and speed in cells of constant acceleration, from u and x alone."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.timing.torque_constraints import dry_friction


def torque_bounds(cells: Cells, u: Array, x: Array, friction: Array) -> tuple[Array, Array]:
    """Largest and smallest torque in each cell, each (m, n) [Nm].

    Args:
        cells: the path enclosed cell by cell.
        u: sddot in each cell [m/s2], shape (m,).
        x: sdot^2 at the ends of the cells [m2/s2], shape (m + 1,).
        friction: (F_s [Nm], F_c [Nm], F_v [Nm s/rad], omega_st [rad/s]) of each joint, shape (n,
            4).
    """
    first = x[:-1, None]
    last = x[1:, None]
    low = np.minimum(first, last)
    high = np.maximum(first, last)
    r_a, r_b, r_e, r_c = cells.remainder
    rest = r_a * np.abs(u)[:, None] + r_b * high + r_e * np.sqrt(high) + r_c
    bottom, top = dry_friction(cells, friction, low[:, 0])
    above = _largest(cells, u, x, 1.0) + top + rest
    below = -_largest(cells, u, x, -1.0) + bottom - rest
    return above, below


def timed_torque_bounds(cells: Cells, friction: Array) -> tuple[Array, Array]:
    """The same for a motion with the time as its parameter: sdot = 1 and sddot = 0."""
    m = len(cells.h)
    if cells.added is not None:
        return torque_bounds(cells, np.zeros(m), np.ones(m + 1), friction)
    _, *rest = cells.remainder
    bottom, top = dry_friction(cells, friction, np.ones(m))
    moving = cells.b + cells.e
    high, low = (bernstein.raised(moving + c, 3) for c in (cells.c_high, cells.c_low))
    miss = sum(rest)
    return bernstein.highest(high) + top + miss, bernstein.lowest(low) + bottom - miss


def _largest(cells: Cells, u: Array, x: Array, side: float) -> Array:
    """Upper bound of side times the torque in each cell, dry friction and remainders left out, (m,
    n) [Nm]."""
    added = cells.added
    a = side * cells.a
    b = side * cells.b
    e = side * cells.e
    c = cells.c_high if side > 0 else -cells.c_low
    rest = np.zeros_like(a[:, 0])
    turn = u[:, None, None]
    extra = np.zeros_like(a)
    if added is not None:
        x_low = np.minimum(x[:-1], x[1:])
        x_high = np.maximum(x[:-1], x[1:])
        extra = np.maximum(turn * side * added.a.low, turn * side * added.a.high)
        line = added.line("speed", side, *added.squared_speed(x_low, x_high))
        b = b + added.b.upper(side) + line.beta[:, None] * added.square
        e = e + added.e.upper(side)
        c = c + line.alpha[:, None]
        rest = np.abs(line.beta) * added.square_remainder * x_high[:, None]
    X = bernstein.linear(x[:-1], x[1:])[..., None]
    base = bernstein.raised(a * turn + extra + c, 3) + bernstein.product(b, X) + _above_root(e, x)
    if added is None or not added.has_load:
        return np.asarray(bernstein.highest(base) + rest)
    a_l, b_l, c_l = added.load
    load = bernstein.raised(a_l * turn + c_l, 3) + bernstein.product(b_l, X)
    r_a, r_b, r_c = added.load_remainder
    own = added.own_friction(x_low, x_high)
    miss = r_a * np.abs(u)[:, None] + r_b * x_high[:, None] + r_c + own
    size = bernstein.largest_size(load) + miss
    line = added.line("load", side, np.zeros_like(size), size)
    # |load| is the larger of load and -load: above a growing law the larger bound, above a falling
    # one either bound
    both = [bernstein.highest(base + k * line.beta[:, None] * load) for k in (1, -1)]
    either = np.where(line.beta >= 0, np.maximum(*both), np.minimum(*both))
    return np.asarray(either + line.alpha + np.abs(line.beta) * miss + rest)


def _above_root(e: Array, x: Array) -> Array:
    """Cubic above e(t) sqrt(x(t)), x linear in t, shape (m, 4, n).

    The root of a linear function is concave: it lies between its secant and the tangent at the
    middle, both linear.
    """
    v = np.sqrt(x)
    secant = bernstein.linear(v[:-1], v[1:])
    middle = np.maximum((x[:-1] + x[1:]) / 2, 1e-300)
    tangent = (middle[:, None] + bernstein.linear(x[:-1], x[1:])) / (2 * np.sqrt(middle))[:, None]
    pushing = bernstein.product(np.maximum(e, 0.0), tangent[..., None])
    return pushing + bernstein.product(np.minimum(e, 0.0), secant[..., None])


def acceleration_ratio(cells: Cells, u: Array, x: Array, qdd_max: Array) -> float:
    """Upper bound of |q' u + q'' x| / qdd_max over all cells; zero without a limit.

    Args:
        cells: the path enclosed cell by cell.
        u: sddot in each cell [m/s2], shape (m,).
        x: sdot^2 at the ends of the cells [m2/s2], shape (m + 1,).
        qdd_max: [rad/s2], shape (n,).
    """
    some = np.isfinite(qdd_max)
    X = bernstein.linear(x[:-1], x[1:])[..., None]
    bend = cells.speed[:, :, some] * u[:, None, None]
    bend = bend + bernstein.product(cells.curvature[:, :, some], X)
    return float((bernstein.largest_size(bend) / qdd_max[some]).max(initial=0.0))


def squared_speed_ratio(cells: Cells, x: Array, qd_max: Array) -> Array:
    """Upper bound of (q'^2 x) / qd_max^2 in each cell, shape (m, n).

    Args:
        cells: the path enclosed cell by cell.
        x: sdot^2 at the ends of the cells [m2/s2], shape (m + 1,).
        qd_max: [rad/s], shape (n,).
    """
    square = bernstein.product(cells.speed, cells.speed) / qd_max**2
    X = bernstein.linear(x[:-1], x[1:])[..., None]
    return bernstein.hull(bernstein.product(square, X))[1]
