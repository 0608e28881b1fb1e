"""Bounds of torque, speed and their rates over all times of a motion along a `SmoothLaw`.

Nothing of the program that found the motion is used, only its numbers. In a part of a cell u is linear and x quadratic
in s, the coefficients are parabolas up to a remainder r, so that every channel, and its rate over sqrt(x), are
polynomials of s with known Bernstein coefficients. What the derivative of a parabola misses is bounded by Cauchy's
integral again: with the remainder of `cells`, at most 6.2 r / w on a part of half width w. sqrt(x) lies between secant
and tangent, 1/sqrt(x) above its tangent.
"""

from __future__ import annotations

from math import comb

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.cells import enclose, reversals
from irb2400_ctrl.planners.certificate import Certificate, Checked
from irb2400_ctrl.planners.path_dynamics import PathDynamics
from irb2400_ctrl.planners.smooth_channels import Channels
from irb2400_ctrl.planners.smooth_law import SmoothLaw

Array = npt.NDArray[np.float64]

# parts that each cell is cut into; more, while a bound is above the limit
_PARTS = (2, 4, 8)
# Cauchy: |f' - p'| <= 3 sqrt(3)/2 (2 + 2/(3 sqrt 3)/(kappa - 1)) |f - p| bound / w, kappa >= 2
_DERIVATIVE = 1.5 * np.sqrt(3) * (2 + 2 / (3 * np.sqrt(3)))
# the law's numbers may disagree by rounding
_ROUNDING = 1e-7


def check_smooth(certificate: Certificate, dynamics: PathDynamics) -> Checked:
    """Bounds over all times; inf where nothing can be said."""
    law = certificate.law
    assert isinstance(law, SmoothLaw)
    if not _consistent(law):
        return Checked(np.inf, np.inf, (float(law.s[0]), 1), np.inf, np.inf, np.inf)
    for parts in _PARTS:
        ratios, s = cell_ratios(certificate, dynamics, parts)
        if max(np.nanmax(r) for r in ratios) <= 1:
            break
    value, rate, speed = ratios
    torques = dynamics.model.robot.n
    cell, axis = np.unravel_index(int(np.argmax(value[:, :torques])), (len(value), torques))
    worst = [float(f.max(initial=0.0)) for f in (value[:, torques:], rate[:, :torques], rate[:, torques:])]
    return Checked(float(value[cell, axis]), float(speed.max()), (float(s[cell]), int(axis) + 1), *worst)


def cell_ratios(
    certificate: Certificate, dynamics: PathDynamics, parts: int
) -> tuple[tuple[Array, Array, Array], Array]:
    """Upper bounds of |y| / limit, |dy/dt| / rate (m, k) and of speed (m, n) on parts of cells, and their ends s."""
    law, limits = certificate.law, certificate.limits
    assert isinstance(law, SmoothLaw)
    inner = law.s[1:-1]
    split = (inner[:-1, None] + np.arange(parts) / parts * np.diff(inner)[:, None]).ravel()
    # nothing is taken for granted: knots and reversals that are not on the law's grid cut its cells
    more = np.concatenate([certificate.path.knots, reversals(certificate.path)])
    more = more[(more > inner[0]) & (more < inner[-1])]
    s = np.unique(np.concatenate([law.s, split, more]))
    cells = enclose(dynamics, certificate.path, s)
    channels = Channels.of(cells, limits, dynamics.model.robot.friction)
    value, rate = _bounds(channels, *_polynomials(law, s))
    G = _product(cells.speed, cells.speed) / limits.qd_max**2
    x, _, _ = _polynomials(law, s)
    speed = np.sqrt(np.maximum(_product(G, x[..., None]).max(axis=1), 0.0))
    if dynamics.irregular or getattr(cells, "added", None) is not None:
        value[:, : dynamics.model.robot.n] = np.inf
    return (value, rate, speed), s


def _consistent(law: SmoothLaw) -> bool:
    """Whether the numbers are those of one motion: x from u, rest at both ends."""
    h, x, u = np.diff(law.s), law.x, law.u
    if not (len(h) > 2 and (h > 0).all() and np.isfinite(u).all() and (x[1:-1] > 0).all()):
        return False
    inner = np.abs(np.diff(x) - h * (u[:-1] + u[1:]))[1:-1] <= _ROUNDING * (x[1:-2] + x[2:-1])
    ends = np.abs([x[1] - 1.5 * h[0] * u[1], x[-2] + 1.5 * h[-1] * u[-2]]) <= _ROUNDING * x[[1, -2]]
    return bool(inner.all() and ends.all() and not (x[[0, -1]] != 0).any() and not (u[[0, -1]] != 0).any())


def _polynomials(law: SmoothLaw, s: Array) -> tuple[Array, Array, Array]:
    """Bernstein coefficients of x (degree 2) and u (degree 1), and u', on parts of the law's cells.

    In the end parts: the largest x, zero and the largest u, and the (constant) jerk over the largest speed for u'.
    """
    cell = np.clip(np.searchsorted(law.s, (s[:-1] + s[1:]) / 2) - 1, 0, len(law.s) - 2)
    beta, first, last = law.slope[cell], s[:-1] - law.s[cell], s[1:] - law.s[cell]
    u = law.u[cell, None] + beta[:, None] * np.stack([first, last], axis=1)
    x0 = law.x[cell] + first * (2 * law.u[cell] + beta * first)
    width = last - first
    x = np.stack([x0, x0 + width * u[:, 0], x0 + width * (u[:, 0] + u[:, 1])], axis=1)
    h = np.diff(law.s)
    for end, near in ((0, 1), (-1, -2)):
        x[end], u[end] = law.x[near], (0.0, law.u[near])
        beta[end] = 2 / 9 * law.x[near] / h[end] ** 2
    return x, u, beta


def _bounds(channels: Channels, x: Array, u: Array, beta: Array) -> tuple[Array, Array]:
    """Upper bounds of |y| / limit and |dy/dt| / rate in each part, each (m, k)."""
    c = channels
    low, high = np.maximum(x.min(axis=1), 0.0)[:, None], x.max(axis=1)[:, None]
    top, bottom = c.dry_friction(low)
    U, X = u[..., None], x[..., None]
    u_max = np.abs(u).max(axis=1)[:, None]
    # sqrt(x): secant of the range below, tangent above
    middle = np.maximum((low + high) / 2, 1e-300)
    r = np.sqrt(middle)
    tangent = (r[:, None] + X / r[:, None]) / 2
    secant = (X + np.sqrt(low * high)[:, None]) / (np.sqrt(low) + np.sqrt(high))[:, None]
    above, below = np.maximum(c.e, 0.0), np.minimum(c.e, 0.0)
    base = _raised(_product(c.a, U), 4) + _product(c.b, X)
    upper = base + _product(above, tangent) + _product(below, secant) + _raised(c.c_high, 4)
    lower = base + _product(above, secant) + _product(below, tangent) + _raised(c.c_low, 4)
    r_a, r_b, r_e, r_c = c.remainder
    rest = r_a * u_max + r_b * high + r_e * np.sqrt(high) + r_c
    value = np.maximum(upper.max(axis=1) + top + rest, -(lower.min(axis=1) + bottom - rest)) / c.limit
    # rates over sqrt(x); the tangent of 1/sqrt(x) is positive as long as x < 3 middle
    d_a, d_b, d_e, d_c = (2 / c.h[:, None, None] * np.diff(f, axis=1) for f in (c.a, c.b, c.e, c.c_high))
    bend = beta[:, None, None]
    g = _raised(_product(d_a, U), 4) + _raised(_product(2 * c.b, U) + _product(d_b, X), 4)
    g += _raised(c.a * bend, 4) + _raised(d_c, 4)
    viscous = _product(c.e, U) + _product(d_e, X)
    g += _raised(viscous, 4) / r[:, None]
    half = c.h[:, None] / 2
    s_a, s_b, s_e, s_c = _DERIVATIVE * c.remainder / half
    spread = np.maximum(1 / np.sqrt(np.maximum(low, 1e-300)) - 1 / r, 1 / r - 1 / np.sqrt(high))
    rest = s_a * u_max + r_a * np.abs(beta)[:, None] + 2 * r_b * u_max + s_b * high + s_c
    rest += (r_e * u_max + s_e * high) / np.sqrt(np.maximum(low, 1e-300)) + np.abs(viscous).max(axis=1) * spread
    line = _raised(1.5 / r[:, None] - X / (2 * r[:, None] ** 3), 4)
    with np.errstate(divide="ignore", invalid="ignore"):
        rate = np.where(line > 0, (np.abs(g) + rest[:, None]) / line, np.inf).max(axis=1) / c.rate
    # where a coefficient lies in a band its slope is not known
    rate = np.where((c.c_high == c.c_low).all(axis=1), rate, np.inf)
    for end in (0, -1):
        value[end], rate[end] = _end_bounds(c, end, x[end], u[end], float(beta[end]))
    return value, np.where(np.isfinite(c.rate), rate, 0.0)


def _end_bounds(c: Channels, end: int, x: Array, u: Array, bend: float) -> tuple[Array, Array]:
    """The same in an end cell: x between 0 and x_1, u between 0 and u_1, the jerk is constant."""
    x1, u1, v1 = float(x[-1]), float(u[-1]), float(np.sqrt(x[-1]))
    top, bottom = c.dry_friction(np.zeros((1, 1)))
    r_a, r_b, r_e, r_c = c.remainder[:, end]
    rest = r_a * abs(u1) + r_b * x1 + r_e * v1 + r_c
    sides = []
    for side, dry, hold in ((1.0, top[end], c.c_high[end]), (-1.0, bottom[end], c.c_low[end])):
        moving = np.maximum((side * u1 * c.a[end]).max(axis=0), 0) + np.maximum((side * x1 * c.b[end]).max(axis=0), 0)
        moving += np.maximum((side * v1 * c.e[end]).max(axis=0), 0)
        sides.append((side * hold).max(axis=0) + side * dry + moving + rest)
    half = c.h[end] / 2
    a, b, e = (np.abs(f[end]).max(axis=0) + m for f, m in ((c.a, r_a), (c.b, r_b), (c.e, r_e)))
    d_a, d_b, d_e, d_c = (
        np.abs(np.diff(f[end], axis=0)).max(axis=0) / half + _DERIVATIVE * m / half
        for f, m in ((c.a, r_a), (c.b, r_b), (c.e, r_e), (c.c_high, r_c))
    )
    rate = v1 * ((d_a + 2 * b) * abs(u1) + a * bend + d_b * x1 + d_c) + e * abs(u1) + d_e * x1
    rate = np.where((c.c_high[end] == c.c_low[end]).all(axis=0), rate / c.rate[end], np.inf)
    return np.maximum(*sides) / c.limit[end], rate


def _product(f: Array, g: Array) -> Array:
    """Bernstein coefficients (axis 1) of the product of two polynomials."""
    p, q = f.shape[1] - 1, g.shape[1] - 1
    shape = np.broadcast_shapes(f.shape[2:], g.shape[2:])
    found = np.zeros((len(f), p + q + 1, *shape))
    for i in range(p + 1):
        for j in range(q + 1):
            found[:, i + j] += comb(p, i) * comb(q, j) / comb(p + q, i + j) * f[:, i] * g[:, j]
    return found


def _raised(f: Array, degree: int) -> Array:
    """The same polynomial with the Bernstein coefficients of a higher degree."""
    more = degree + 1 - f.shape[1]
    return _product(f, np.ones((len(f), more + 1, *[1] * (f.ndim - 2))))
