"""Bounds of torque and speed in cells of constant acceleration, from u and x alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.timing.torque_constraints import dry_friction

Array = npt.NDArray[np.float64]


def torque_bounds(cells: Cells, u: Array, x: Array, friction: Array) -> tuple[Array, Array]:
    """Largest and smallest torque in each cell, each (m, n) [Nm]."""
    first = x[:-1, None]
    last = x[1:, None]
    low = np.minimum(first, last)
    high = np.maximum(first, last)
    r_a, r_b, r_e, r_c = cells.remainder
    rest = r_a * np.abs(u)[:, None] + r_b * high + r_e * np.sqrt(high) + r_c
    forwards, backwards = dry_friction(cells, friction, low[:, 0])
    F_c = np.minimum(friction[:, 0], friction[:, 1])
    top = np.where(cells.forwards, forwards, np.where(cells.backwards, -F_c, 0.0))
    bottom = np.where(cells.backwards, -backwards, np.where(cells.forwards, F_c, 0.0))
    above = _largest(cells, u, x, 1.0) + top + rest
    below = -_largest(cells, u, x, -1.0) + bottom - rest
    return above, below


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
    base = raised(a * turn + extra + c) + _times_linear(b, x[:-1], x[1:]) + _root_range(e, x)[1]
    if added is None or not added.has_load:
        return np.asarray(base.max(axis=1) + rest)
    a_l, b_l, c_l = added.load
    load = raised(a_l * turn + c_l) + _times_linear(b_l, x[:-1], x[1:])
    r_a, r_b, r_c = added.load_remainder
    miss = r_a * np.abs(u)[:, None] + r_b * x_high[:, None] + r_c
    size = np.abs(load).max(axis=1) + miss
    line = added.line("load", side, np.zeros_like(size), size)
    # |load| is the larger of load and -load: above a growing law the larger bound, above a falling
    # one either bound
    both = [(base + k * line.beta[:, None] * load).max(axis=1) for k in (1, -1)]
    either = np.where(line.beta >= 0, np.maximum(*both), np.minimum(*both))
    return np.asarray(either + line.alpha + np.abs(line.beta) * miss + rest)


def _root_range(e: Array, x: Array) -> tuple[Array, Array]:
    """Cubic Bernstein coefficients below and above e(t) sqrt(x(t)), x linear in t; each (m, 4, n).

    The root of a linear function is concave: it lies between its secant and the tangent at the
    middle, both linear.
    """
    v = np.sqrt(x)
    secant = v[:-1], v[1:]
    middle = np.maximum((x[:-1] + x[1:]) / 2, 1e-300)
    tangent = (middle + x[:-1]) / (2 * np.sqrt(middle)), (middle + x[1:]) / (2 * np.sqrt(middle))
    positive = np.maximum(e, 0.0)
    negative = np.minimum(e, 0.0)
    low = _times_linear(positive, *secant) + _times_linear(negative, *tangent)
    high = _times_linear(positive, *tangent) + _times_linear(negative, *secant)
    return low, high


def _times_linear(f: Array, first: Array, last: Array) -> Array:
    """Product of a parabola f (m, 3, n) with the linear function from `first` to `last` (m,),
    degree 3."""
    x0 = first[:, None]
    x1 = last[:, None]
    terms = [
        f[:, 0] * x0,
        (f[:, 0] * x1 + 2 * f[:, 1] * x0) / 3,
        (2 * f[:, 1] * x1 + f[:, 2] * x0) / 3,
        f[:, 2] * x1,
    ]
    return np.stack(terms, axis=1)


def raised(f: Array) -> Array:
    """Degree 2 to degree 3, along axis 1."""
    return np.stack(
        [f[:, 0], (f[:, 0] + 2 * f[:, 1]) / 3, (2 * f[:, 1] + f[:, 2]) / 3, f[:, 2]], axis=1
    )


def squared_speed_ratio(cells: Cells, x: Array, qd_max: Array) -> Array:
    """Upper bound of (q'^2 x) / qd_max^2 in each cell, by the Bernstein coefficients of degree 5,
    shape (m, n)."""
    s0 = cells.speed[:, 0]
    s1 = cells.speed[:, 1]
    s2 = cells.speed[:, 2]
    G = np.stack([s0**2, s0 * s1, (2 * s1**2 + s0 * s2) / 3, s1 * s2, s2**2], axis=1) / qd_max**2
    k = np.arange(6)[None, :, None]
    padded = np.concatenate([G, np.zeros_like(G[:, :1])], axis=1)
    shifted = np.concatenate([np.zeros_like(G[:, :1]), G], axis=1)
    coefficients = (5 - k) / 5 * padded * x[:-1, None, None] + k / 5 * shifted * x[1:, None, None]
    return np.asarray(coefficients.max(axis=1))
