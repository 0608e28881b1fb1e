"""Torque of effects beside the regular form (`effect_forms`), bounded on the cells of a path.

A factor g of the time lies between its bounds, so a u + b x + ... becomes a range of coefficients.
A law f(w) of the squared speed or of the size of the load lies below a straight line alpha + beta w
over the values that w takes in the cell, and above another one:

    any f        chord + (w_1 - w_0)^2 / 8 max(0, -f'')        f'' bounded over the range
    (`interval`)
    concave f    tangent in the middle
    any f        the largest value

whichever is lowest in the middle. With w = q'^2 x the line is linear in x again; with w = |L|, L =
a u + b x + c, it is the larger of two linear functions (beta > 0, two rows), or lies below one of
them (beta < 0, L of the sign expected). Own friction that counts as load is at most so far from
it: it widens what the parabolas of L may miss.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.effect_forms import ScalarLaw
from irb2400_ctrl.planners.enclosure.interval import Interval


@dataclass(frozen=True)
class Range:
    """Parabolas below and above what factors of the time may add to a coefficient; Bernstein, shape
    (m, 3, n)."""

    low: Array
    high: Array

    @classmethod
    def of(cls, parts: list[Array], low: Array, high: Array) -> Range:
        """Sum of g_k parts[k] over low_k <= g_k <= high_k."""
        ends = [
            (np.minimum(a * f, b * f), np.maximum(a * f, b * f))
            for f, a, b in zip(parts, low, high, strict=True)
        ]
        return cls(
            sum((e[0] for e in ends[1:]), ends[0][0]), sum((e[1] for e in ends[1:]), ends[0][1])
        )

    def upper(self, side: float) -> Array:
        """Upper bound of side times the coefficient's range."""
        return self.high if side > 0 else -self.low


@dataclass(frozen=True)
class LinearBound:
    """alpha + beta w per cell and joint, shapes (m, n)."""

    alpha: Array
    beta: Array


@dataclass(frozen=True)
class Added:
    """What the cells of a path know about effects beside the regular form."""

    a: Range
    b: Range
    e: Range
    laws: tuple[ScalarLaw, ...]
    direction: Interval
    """bounds of sgn(qd), each (m, n)"""
    states: tuple[Interval, ...]
    """bounds of each law's memory, each (m,)"""
    load: tuple[Array, Array, Array]
    """a, b, c of the load of the transmissions, (m, 3, n); empty arrays where no law needs it"""
    load_remainder: Array
    """bounds of the distance from these parabolas, shape (3, m, n)"""
    square: Array
    """parabola of q'^2, shape (m, 3, n)"""
    square_remainder: Array
    """shape (m, n)"""
    friction: FrictionLaw
    """of the arm"""

    @property
    def has_load(self) -> bool:
        """Whether a law depends on the load."""
        return any(law.of == "load" for law in self.laws)

    @property
    def has_acceleration(self) -> bool:
        """Whether a factor of the time that varies multiplies u."""
        return bool((self.a.low != self.a.high).any())

    def line(
        self, of: Literal["speed", "load"], side: float, low: Array, high: Array
    ) -> LinearBound:
        """The laws' sum on each joint, times side, lies below this line for w between low and high
        (m, n)."""
        alpha = np.zeros_like(low)
        beta = np.zeros_like(low)
        for law, state in zip(self.laws, self.states, strict=True):
            if law.of == of:
                j = law.joint
                direction = self.direction[0][:, j], self.direction[1][:, j]
                first, slope = line_above(law, side, low[:, j], high[:, j], direction, state)
                alpha[:, j] += first
                beta[:, j] += slope
        return LinearBound(alpha, beta)

    def squared_speed(self, x_low: Array, x_high: Array) -> tuple[Array, Array]:
        """Bounds of qd^2 in each cell, (m, n) [rad2/s2]."""
        least, most = bernstein.hull(self.square)
        low = np.maximum(least - self.square_remainder, 0.0)
        high = np.maximum(most + self.square_remainder, 0.0)
        return low * x_low[:, None], high * x_high[:, None]

    def own_friction(self, x_low: Array, x_high: Array) -> Array:
        """Upper bound of the friction that laws of the load count as load, (m, n) [Nm]; of the
        arm's joints, not of a rail or a table beside them.

        Args:
            x_low, x_high: bounds of the squared path speed in the cells, (m,).
        """
        found = np.zeros((len(x_low), self.square.shape[2]))
        shares = [(law.joint, law.own_friction) for law in self.laws if law.own_friction]
        if not shares:
            return found
        arm = slice(len(self.friction.viscous))
        slow, fast = (qd2[:, arm] for qd2 in self.squared_speed(x_low, x_high))
        most = self.friction.level_range(slow)[1] + self.friction.viscous * np.sqrt(fast)
        for j, share in shares:
            found[:, j] = np.maximum(found[:, j], share * most[:, j])
        return found

    def load_size(self, u: Array, x: Array) -> Array:
        """Upper bound of |load| for accelerations up to |u| and squares of speed up to x (m,),
        shape (m, n) [Nm]."""
        a, b, c = (
            bernstein.largest_size(f) + r
            for f, r in zip(self.load, self.load_remainder, strict=True)
        )
        return np.asarray(a * np.abs(u)[:, None] + b * x[:, None] + c)


@dataclass(frozen=True)
class Variant:
    """One combination that has to stay below the limit: a u + b x + e sqrt(x) + c + rest, all times
    the side."""

    a: Array
    b: Array
    e: Array
    c: Array
    """Bernstein coefficients, shape (m, 3, n)"""
    rest: Array
    """shape (m, n)"""


def variants(
    added: Added,
    plain: Variant,
    side: float,
    bar: tuple[Array, Array],
    box: tuple[Array, Array, Array],
    tau_max: Array,
) -> list[Variant]:
    """The rows of one side, effects beside the regular form included.

    Args:
        added: what the cells know.
        plain: the arm and its regular effects, times the side.
        side: 1 above, -1 below.
        bar: u and x expected in each cell, where the sign of the load is taken, shapes (m,).
        box: x_low, x_high and the bound of |u| in each cell, shapes (m,).
        tau_max: torque limits [Nm], shape (n,).
    """
    x_low, x_high, u_max = box
    safe = bool(np.isfinite(u_max).all())
    largest = u_max if safe else np.abs(bar[0])
    X = x_high[:, None]
    speed = added.line("speed", side, *added.squared_speed(x_low, x_high))
    b = plain.b + added.b.upper(side) + speed.beta[:, None] * added.square
    c = plain.c + speed.alpha[:, None]
    rest = plain.rest + np.abs(speed.beta) * added.square_remainder * X
    e = plain.e + added.e.upper(side)
    ends = [added.a.low, added.a.high] if added.has_acceleration else [added.a.high]
    found = [Variant(plain.a + side * end, b, e, c, rest) for end in ends]
    if not added.has_load:
        return found
    a_l, b_l, c_l = added.load
    r_a, r_b, r_c = added.load_remainder
    own = added.own_friction(x_low, x_high)
    miss = r_a * (largest[:, None] if safe else 0.0) + r_b * X + r_c + own
    size = np.minimum(added.load_size(largest, x_high) + own, load_cap(added, tau_max) + miss)
    line = added.line("load", side, np.zeros_like(size), size)
    expected = np.sign(
        (a_l * bar[0][:, None, None] + b_l * bar[1][:, None, None] + c_l).sum(axis=1)
    )
    rest_l = np.abs(line.beta) * miss
    both = []
    for sign in (1.0, -1.0):
        k = np.where(line.beta >= 0, sign * line.beta, expected * line.beta)[:, None]
        both += [
            Variant(
                v.a + k * a_l,
                v.b + k * b_l,
                v.e,
                v.c + k * c_l + line.alpha[:, None],
                v.rest + rest_l,
            )
            for v in found
        ]
    return both


def load_cap(added: Added, tau_max: Array) -> Array:
    """Largest |load| that rows of their own allow where a law of it is curved, shape (n,) [Nm].

    Far above what a motor within its limit can move, so that it costs nothing; the law is bounded
    up to here only.
    """
    cap = np.full(tau_max.shape, np.inf)
    for law in added.laws:
        if law.of == "load" and law.curved:
            cap[law.joint] = 2 * tau_max[law.joint]
    return cap


def line_above(
    law: ScalarLaw, side: float, low: Array, high: Array, direction: Interval, state: Interval
) -> tuple[Array, Array]:
    """alpha and beta with side f(w) <= alpha + beta w for low <= w <= high, whatever factors and
    memory; (m,) each."""
    middle = (low + high) / 2
    width = high - low

    def sided(bounds: Interval) -> Interval:
        first, last = (np.broadcast_to(b, low.shape) for b in bounds)
        return (first, last) if side > 0 else (-last, -first)

    over = [sided(b) for b in law.bounds((low, high), direction, state)]
    first, last, centre = (law.bounds((w, w), direction, state) for w in (low, high, middle))
    start = sided(first[0])[1]
    end = sided(last[0])[1]
    level = sided(centre[0])[1]
    slope = sided(centre[1])
    with np.errstate(all="ignore"):
        chord = np.where(width > 0, (end - start) / width, 0.0)
        bulge = width**2 / 8 * np.maximum(0.0, -over[2][0])
        tangent = (slope[0] + slope[1]) / 2
        miss = (slope[1] - slope[0]) / 2 * width / 2
        at_middle = np.stack(
            [
                (start + end) / 2 + np.where(width > 0, bulge, 0.0),
                np.where(over[2][1] <= 0, level + miss, np.inf),
                over[0][1],
            ]
        )
        betas = np.stack([chord, tangent, np.zeros_like(chord)])
    usable = np.isfinite(at_middle) & np.isfinite(betas)
    best = np.argmin(np.where(usable, at_middle, np.inf), axis=0)[None]
    value = np.take_along_axis(np.where(usable, at_middle, np.inf), best, axis=0)[0]
    beta = np.take_along_axis(np.where(usable, betas, 0.0), best, axis=0)[0]
    return value - beta * middle, beta


def memories(laws: tuple[ScalarLaw, ...], q: Array, direction: Interval) -> tuple[Interval, ...]:
    """Bounds of the laws' memory in the cells, from how far the joints have turned since they last
    turned back.

    Args:
        laws: laws with and without memory.
        q: joint angles at the ends of the cells, shape (m + 1, n) [rad].
        direction: bounds of sgn(qd) in the cells, shapes (m, n).
    """
    m = len(q) - 1
    found = []
    for law in laws:
        if law.memory is None:
            found.append((np.zeros(m), np.zeros(m)))
            continue
        low = direction[0][:, law.joint]
        high = direction[1][:, law.joint]
        one_way = (low == high) & (low != 0)
        number = np.arange(m)
        heading = np.where(one_way, low, 0.0)
        # the cell in which the joint moved last: standing still keeps the memory
        moved = np.maximum.accumulate(np.where(low == high, np.where(one_way, number, -1), number))
        before = np.where(np.roll(moved, 1) >= 0, heading[np.roll(moved, 1)], 0.0)
        before[0] = 0.0
        step = np.where(one_way, np.abs(np.diff(q[:, law.joint])), 0.0)
        way = np.cumsum(step) - step
        begun = np.maximum.accumulate(np.where(one_way & (heading != before), number, 0))
        turned = np.where(one_way, way - way[begun], 0.0)
        below, above = law.memory(turned)
        wide = np.maximum(np.abs(below), np.abs(above))
        lower = np.where(heading < 0, -above, below)
        upper = np.where(heading < 0, -below, above)
        found.append((np.where(one_way, lower, -wide), np.where(one_way, upper, wide)))
    return tuple(found)
