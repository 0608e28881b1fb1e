"""`OutputRatios`: torque, speed and their rates over all times of a motion without jumps, bounded.

Nothing of the program that found the motion is used, only its numbers. In a part of a cell u is
linear and x quadratic in s, the coefficients are parabolas up to a remainder r, so that every
output, and its rate over sqrt(x), are polynomials of s with known Bernstein coefficients. What the
derivative of a parabola misses is bounded by Cauchy's integral again: with the remainder of
`cells`, at most 6.2 r / w on a part of half width w. sqrt(x) lies between secant and tangent,
1/sqrt(x) above its tangent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.planners.enclosure.bernstein import hull, product, raised
from irb2400_ctrl.planners.enclosure.cells import enclose
from irb2400_ctrl.planners.enclosure.effect_bounds import Added, Variant, variants
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.cell_motion import CellMotion
from irb2400_ctrl.planners.timing.rate_limited.constrained_outputs import ConstrainedOutputs
from irb2400_ctrl.planners.timing.torque_constraints import ROUNDING

_RATIOS = ("value", "rate", "speed")
# a bound is close to the largest from this part of it on
_CLOSE = 0.95
# parts that are bounded at once: what they need fits a processor's cache
_AT_ONCE = 1000
# Cauchy: |f' - p'| <= 3 sqrt(3)/2 (2 + 2/(3 sqrt 3)/(kappa - 1)) |f - p| bound / w, kappa >= 2
_DERIVATIVE = 1.5 * np.sqrt(3) * (2 + 2 / (3 * np.sqrt(3)))


@dataclass(frozen=True)
class OutputRatios:
    """Upper bounds on m parts of cells, as parts of the limits; the torques come first."""

    s: Array
    """ends of the parts [m], shape (m + 1,)"""
    value: Array
    """|y| / limit, shape (m, k)"""
    rate: Array
    """|dy/dt| / rate, zero where there is no limit, shape (m, k)"""
    speed: Array
    """|qd| / qd_max, shape (m, n)"""

    def to_cut(self, tight: bool) -> Mask:
        """Parts on which smaller ones may say more: where something is above a limit, and, to know
        the largest of each ratio well, where one is close to it; none at the ends of the motion."""
        every = np.hstack([self.value, self.rate, self.speed])
        enough = np.minimum(_CLOSE * every.max(axis=0), 1 - ROUNDING) if tight else 1 - ROUNDING
        found = np.asarray(~(every <= enough).all(axis=1))
        found[[0, -1]] = False
        return found

    def cut(self, cut: Mask, s: Array, more: OutputRatios) -> OutputRatios:
        """The same with the parts `cut` halved, which ends them at s, and bounded anew."""
        found = []
        for own, other in ((getattr(r, k) for r in (self, more)) for k in _RATIOS):
            both = np.repeat(own, 1 + cut, axis=0)
            both[np.repeat(cut, 1 + cut)] = other
            found.append(both)
        return OutputRatios(s, *found)

    def checked(self, n: int) -> Checked:
        """The largest of each kind; the first n outputs are torques, the others accelerations."""
        torque = self.value[:, :n]
        cell, axis = np.unravel_index(int(np.argmax(torque)), torque.shape)
        return Checked(
            torque_ratio=float(torque[cell, axis]),
            velocity_ratio=float(self.speed.max()),
            torque_at=(float(self.s[cell]), int(axis) + 1),
            acceleration_ratio=float(self.value[:, n:].max(initial=0.0)),
            torque_rate_ratio=float(self.rate[:, :n].max(initial=0.0)),
            jerk_ratio=float(self.rate[:, n:].max(initial=0.0)),
        )


def output_ratios(
    motion: CellMotion,
    path: JointPath,
    limits: MotionLimits,
    dynamics: PathDynamics,
    *,
    whole: bool = True,
) -> OutputRatios:
    """Upper bounds of the constrained outputs and the speeds; inf where nothing can be said.

    Args:
        motion: on parts of cells.
        path, limits, dynamics: what moves, and what it has to keep.
        whole: from rest to rest; else parts within the motion.
    """
    m = len(motion.slope)
    count = _AT_ONCE if dynamics.local else m
    found = []
    for first in range(0, m, count):
        last = min(first + count, m)
        ends = (*([0] if first == 0 else []), *([-1] if last == m else [])) if whole else ()
        found.append(_ratios(motion.part(first, last), path, limits, dynamics, ends))
    return OutputRatios(
        motion.s, *(np.concatenate([getattr(part, k) for part in found]) for k in _RATIOS)
    )


def _ratios(
    motion: CellMotion,
    path: JointPath,
    limits: MotionLimits,
    dynamics: PathDynamics,
    ends: tuple[int, ...],
) -> OutputRatios:
    """Some of them; `ends`: which of the first (0) and the last (-1) begin and end at rest."""
    n = dynamics.n
    cells = enclose(dynamics, path, motion.s)
    outputs = ConstrainedOutputs.of(cells, limits, dynamics.friction)
    squared_speed = product(cells.speed, cells.speed) / limits.qd_max**2
    most = hull(product(squared_speed, motion.x[..., None]))[1]
    value = _values(outputs, cells.added, motion.x, motion.u, ends)
    rate = _rates(outputs, motion.x, motion.u, motion.slope, ends)
    if dynamics.irregular:
        value[:, :n] = np.inf
    if dynamics.irregular or cells.added is not None:
        # effects of time, load or memory: the slopes of their torques have no bound here
        rate[:, :n] = np.where(np.isfinite(outputs.rate[:, :n]), np.inf, 0.0)
    return OutputRatios(motion.s, value, rate, np.sqrt(np.maximum(most, 0.0)))


def _values(
    c: ConstrainedOutputs, added: Added | None, x: Array, u: Array, ends: tuple[int, ...]
) -> Array:
    """Upper bounds of |y| / limit in each part, shape (m, k)."""
    low = np.maximum(x.min(axis=1), 0.0)
    high = x.max(axis=1)
    low[np.array(ends, dtype=int)] = 0.0
    u_max = np.abs(u).max(axis=1)
    r_a, r_b, r_e, r_c = c.remainder
    rest = r_a * u_max[:, None] + r_b * high[:, None] + r_e * np.sqrt(high)[:, None] + r_c
    bottom, top = c.dry_friction(low[:, None])
    found = []
    for side, dry, held in ((1.0, top, c.c_high), (-1.0, -bottom, -c.c_low)):
        plain = Variant(side * c.a, side * c.b, side * c.e, held, rest)
        found.append(_above(plain, x, u, low, high, ends) + dry)
        if added is not None:
            n = added.square.shape[-1]
            torques = Variant(
                *(f[..., :n] for f in (plain.a, plain.b, plain.e, plain.c, plain.rest))
            )
            bar = (u.mean(axis=1), (low + high) / 2)
            box = (low, high, u_max)
            every = variants(added, torques, side, bar, box, np.full(n, np.inf))
            found[-1][:, :n] = (
                np.max([_above(v, x, u, low, high, ends) for v in every], axis=0) + dry[:, :n]
            )
    return np.asarray(np.maximum(*found) / c.limit)


def _above(v: Variant, x: Array, u: Array, low: Array, high: Array, ends: tuple[int, ...]) -> Array:
    """Upper bound of a u + b x + e sqrt(x) + c + rest in each part, shape (m, k)."""
    U = u[..., None]
    X = x[..., None]
    # sqrt(x): secant of the range below, tangent above
    r = np.sqrt(np.maximum((low + high) / 2, 1e-300))[:, None, None]
    first = np.sqrt(low)[:, None, None]
    last = np.sqrt(high)[:, None, None]
    tangent = (r + X / r) / 2
    secant = (X + first * last) / (first + last)
    found = raised(product(v.a, U), 4) + product(v.b, X) + raised(v.c, 4)
    found += product(np.maximum(v.e, 0.0), tangent) + product(np.minimum(v.e, 0.0), secant)
    bound = found.max(axis=1) + v.rest
    for end in ends:
        # x between 0 and x_1, u between 0 and u_1: every term at its largest
        u1 = float(u[end, -1] if end == 0 else u[end, 0])
        x1 = float(high[end])
        terms = ((u1, v.a), (x1, v.b), (np.sqrt(x1), v.e))
        bound[end] = v.c[end].max(axis=0) + v.rest[end]
        bound[end] += sum(np.maximum((size * f[end]).max(axis=0), 0.0) for size, f in terms)
    return np.asarray(bound)


def _rates(c: ConstrainedOutputs, x: Array, u: Array, beta: Array, ends: tuple[int, ...]) -> Array:
    """Upper bounds of |dy/dt| / rate in each part, zero where there is no limit, shape (m, k)."""
    low = np.maximum(x.min(axis=1), 1e-300)[:, None]
    high = x.max(axis=1)[:, None]
    U = u[..., None]
    X = x[..., None]
    bend = beta[:, None, None]
    u_max = np.abs(u).max(axis=1)[:, None]
    r_a, r_b, r_e, _ = c.remainder
    half = c.h[:, None] / 2
    s_a, s_b, s_e, s_c = _DERIVATIVE * c.remainder / half
    # over sqrt(x); the tangent of 1/sqrt(x) is positive as long as x < 3 r^2
    r = np.sqrt((low + high) / 2)
    d_a, d_b, d_e, d_c = (np.diff(f, axis=1) / half[:, None] for f in (c.a, c.b, c.e, c.c_high))
    viscous = product(c.e, U) + product(d_e, X)
    g = raised(product(d_a, U) + c.a * bend, 4) + raised(product(2 * c.b, U) + product(d_b, X), 4)
    g += raised(d_c, 4) + raised(viscous, 4) / r[:, None]
    # 1/sqrt(x) is convex: it departs most from its value in the middle where x is least
    spread = 1 / np.sqrt(low) - 1 / r
    rest = (s_a + 2 * r_b) * u_max + r_a * np.abs(beta)[:, None] + s_b * high + s_c
    rest += (r_e * u_max + s_e * high) / np.sqrt(low) + np.abs(viscous).max(axis=1) * spread
    line = raised(1.5 / r[:, None] - X / (2 * r[:, None] ** 3), 4)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.where(line > 0, (np.abs(g) + rest[:, None]) / line, np.inf).max(axis=1)
    for end in ends:
        # the jerk is constant, and every other term at its largest
        u1 = float(u_max[end, 0])
        x1 = float(high[end, 0])
        a, b, e = (
            np.abs(f[end]).max(axis=0) + miss[end]
            for f, miss in ((c.a, r_a), (c.b, r_b), (c.e, r_e))
        )
        slopes = ((d_a, s_a), (d_b, s_b), (d_e, s_e), (d_c, s_c))
        p, q, s, t = (np.abs(d[end]).max(axis=0) + miss[end] for d, miss in slopes)
        found[end] = np.sqrt(x1) * ((p + 2 * b) * u1 + a * beta[end] + q * x1 + t) + e * u1 + s * x1
    # where a coefficient lies in a band its slope is not known
    found = np.where((c.c_high == c.c_low).all(axis=1), found, np.inf)
    return np.where(np.isfinite(c.rate), found / c.rate, 0.0)
