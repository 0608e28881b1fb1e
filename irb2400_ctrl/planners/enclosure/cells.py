"""`Cells`: the torque of a path enclosed cell by cell, for every point of the path.

The path is cut so that q(s) is one cubic in each cell and no joint changes its direction inside
one. There the coefficients a, b, e, c of `path_dynamics` are replaced by `parabolas`, and what
those miss is bounded. No sample enters: what is enclosed here holds at every instant.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.effect_bounds import Added, Range, memories
from irb2400_ctrl.planners.enclosure.parabolas import parabolas
from irb2400_ctrl.planners.enclosure.path_dynamics import OUTPUTS, PathDynamics
from irb2400_ctrl.planners.grids import divided
from irb2400_ctrl.planners.joint_path import JointMotion, JointPath

# largest turn of a joint within a cell [rad]
_TURN = 0.03
# cells shorter than this part of their neighbours' spacing are not cut off at a reversal
_SLIVER = 1e-6
# rounding of a length and of a speed, as parts of them
_ROUNDING = 32 * np.finfo(float).eps
# arrays of `Cells` with a row for each
_COLUMNS = ("a", "b", "e", "c_low", "c_high", "speed", "forwards", "backwards", "curvature")


@dataclass(frozen=True)
class Cells:
    """Coefficients on m cells of an n-joint path, as Bernstein coefficients of degree 2 (second
    axis)."""

    s: Array
    """ends of the cells [m], shape (m + 1,)"""
    a: Array
    b: Array
    e: Array
    """parabolas of the coefficients, shape (m, 3, n)"""
    c_low: Array
    c_high: Array
    """c between the directions of motion that occur in the cell, shape (m, 3, n)"""
    remainder: Array
    """bounds of the distance of a, b, e, c from their parabolas, shape (4, m, n)"""
    speed: Array
    """q' (exact), Bernstein coefficients, shape (m, 3, n) [rad/m]"""
    forwards: Mask
    backwards: Mask
    """whether the joint moves in that direction somewhere in the cell, shape (m, n)"""
    curvature: Array
    """q'' at both ends (linear between), shape (m, 2, n) [rad/m2]"""
    added: Added | None = None
    """effects beside the regular form"""

    @property
    def h(self) -> Array:
        """Lengths of the cells [m], shape (m,)."""
        return np.diff(self.s)

    def part(self, of: slice) -> Cells:
        """Some neighbouring cells; all of them where effects beside the regular form know the
        whole way."""
        if of == slice(0, len(self.h)):
            return self
        assert self.added is None
        columns: dict[str, Any] = {name: getattr(self, name)[of] for name in _COLUMNS}
        return Cells(self.s[of.start : of.stop + 1], remainder=self.remainder[:, of], **columns)


def grid(path: JointPath, count: int) -> Array:
    """Ends of cells: knots, joint reversals, and even steps so that there are about `count` [m]."""
    turned = np.abs(np.diff(path(path.knots), axis=0)).max(axis=1)
    by_turn = np.ceil(turned / _TURN)
    by_length = np.ceil(np.diff(path.knots) / (path.length / count) - 1e-9)
    parts = np.maximum(1, np.maximum(by_length, by_turn)).astype(int)
    return with_reversals(path, divided(path.knots, parts))


def with_reversals(path: JointMotion, s: Array) -> Array:
    """The grid with the zeros of every q_j'(s) added, unless they are next to a grid point."""
    s = np.unique(np.concatenate([s, path.reversals()]))
    gap = np.diff(s)
    # points that fall together: several joints turn back at one place, beside a knot
    group = np.concatenate([[0], np.cumsum(gap >= _SLIVER * np.median(gap))])
    knot = np.isin(s, path.knots)
    # of them the knot stays: the polynomial changes there; the last one where there is none
    last = np.append(np.diff(group) > 0, True)
    with_knot = np.bincount(group, knot) > 0
    return s[np.where(with_knot[group], knot, last)]


def at_once(dynamics: PathDynamics, s: Array) -> list[slice]:
    """Which of the cells between the lengths s are enclosed at once: what a law remembers of the
    way is not known in the middle of it."""
    count = len(s) - 1
    return bernstein.blocks(count) if dynamics.local else [slice(0, count)]


def enclose(dynamics: PathDynamics, path: JointMotion, s: Array) -> Cells:
    """The enclosure on the cells between the lengths s (knots of the path included)."""
    parts = at_once(dynamics, s)
    if len(parts) == 1:
        return _enclose(dynamics, path, s)
    # into their places one after another: all of them beside the whole would be twice as much
    count = len(s) - 1
    remainder = np.empty((4, count, dynamics.n))
    whole: dict[str, Any] = {}
    for part in parts:
        found = _enclose(dynamics, path, s[part.start : part.stop + 1])
        remainder[:, part] = found.remainder
        for name in _COLUMNS:
            values = getattr(found, name)
            if name not in whole:
                whole[name] = np.empty((count, *values.shape[1:]), values.dtype)
            whole[name][part] = values
    return Cells(s=s, remainder=remainder, **whole)


def _enclose(dynamics: PathDynamics, path: JointMotion, s: Array) -> Cells:
    """All cells at once; with laws that remember their way there is no other order."""
    fitted, remainder = parabolas(path, s, dynamics.coefficients, dynamics.radii)
    ranges, rest = _time_ranges(fitted, remainder, dynamics.factors)
    speed, curvature = _derivatives(path, s)
    forwards, backwards = _directions(s, speed, curvature)
    c_low, c_high = _static_band(fitted[3:6], ranges[3:], forwards, backwards)
    a, b, e = fitted[:3]
    added = None
    if ranges or dynamics.forms.laws:
        direction = (
            np.where(backwards, -1.0, np.where(forwards, 1.0, 0.0)),
            np.where(forwards, 1.0, np.where(backwards, -1.0, 0.0)),
        )
        nothing = Range(np.zeros_like(a), np.zeros_like(a))
        load, load_rest = _load(fitted, remainder, dynamics.needs_load)
        square, missed = _square(speed)
        a_range, b_range, e_range = ranges[:3] or [nothing] * 3
        added = Added(
            a=a_range,
            b=b_range,
            e=e_range,
            laws=dynamics.forms.laws,
            direction=direction,
            states=memories(dynamics.forms.laws, path(s), direction),
            load=load,
            load_remainder=load_rest,
            square=square,
            square_remainder=missed,
            friction=FrictionLaw.of(dynamics.model.robot),
        )
    return Cells(
        s=s,
        a=a,
        b=b,
        e=e,
        c_low=c_low,
        c_high=c_high,
        remainder=np.stack([*rest[:3], rest[3:].max(axis=0)]),
        speed=speed,
        forwards=forwards,
        backwards=backwards,
        curvature=curvature,
        added=added,
    )


def _time_ranges(
    fitted: list[Array], remainder: Array, factors: tuple[Array, Array]
) -> tuple[list[Range], Array]:
    """What bounded factors of the time add to each coefficient, and the remainders with it: they
    simply add up, shape (6, m, n)."""
    low, high = factors
    count = len(OUTPUTS)
    rest = np.array(remainder[:count])
    for k, size in enumerate(np.maximum(np.abs(low), np.abs(high))):
        rest += size * remainder[count * (k + 1) : count * (k + 2)]
    if not len(low):
        return [], rest
    timed = [[fitted[count * (k + 1) + i] for k in range(len(low))] for i in range(count)]
    return [Range.of(parts, low, high) for parts in timed], rest


def _derivatives(path: JointMotion, s: Array) -> tuple[Array, Array]:
    """q' as Bernstein coefficients (m, 3, n), and q'' at both ends (m, 2, n)."""
    middle = s[:-1] + np.diff(s) / 2
    piece = path.piece(middle)
    # q' is a parabola, or linear
    speed = bernstein.through(*(path.on_piece(at, piece, 1) for at in (s[:-1], middle, s[1:])))
    curved = bernstein.linear(*(path.on_piece(at, piece, 2) for at in (s[:-1], s[1:])))
    return speed, curved


def _directions(s: Array, speed: Array, curvature: Array) -> tuple[Mask, Mask]:
    """Whether each joint moves forwards, and backwards, somewhere in each cell, shapes (m, n).

    A cell that ends at a reversal ends there up to the rounding of s, and q' is zero up to what q''
    makes of it, however small the cell: that is no motion the other way.
    """
    place = np.abs(s).max() * bernstein.largest_size(curvature)
    noise = _ROUNDING * (place + bernstein.largest_size(speed))
    slowest, fastest = bernstein.hull(speed)
    return fastest > noise, slowest < -noise


def _static_band(
    c: list[Array], ranges: list[Range], forwards: Mask, backwards: Mask
) -> tuple[Array, Array]:
    """c between the directions of motion that occur in each cell, from those for motion backwards,
    at rest and forwards; shapes (m, 3, n)."""
    below = list(c)
    above = list(c)
    for i, found in enumerate(ranges):
        below[i] = below[i] + found.low
        above[i] = above[i] + found.high
    still = ~(forwards ^ backwards)
    c_high = np.full_like(c[0], -np.inf)
    c_low = np.full_like(c[0], np.inf)
    for used, lower, upper in zip((backwards, still, forwards), below, above, strict=True):
        c_high = np.where(used[:, None], np.maximum(c_high, upper), c_high)
        c_low = np.where(used[:, None], np.minimum(c_low, lower), c_low)
    return c_low, c_high


def _load(
    fitted: list[Array], remainder: Array, needed: bool
) -> tuple[tuple[Array, Array, Array], Array]:
    """a, b, c of the transmissions' load and their remainders; empty where no law needs it."""
    if not needed:
        nothing = np.empty(0)
        return (nothing, nothing, nothing), np.empty((3, 0, 0))
    a, b, c = fitted[-3:]
    return (a, b, c), remainder[-3:]


def _square(speed: Array) -> tuple[Array, Array]:
    """Parabola of q'^2 through its values at start, middle and end, and what it misses."""
    s0 = speed[:, 0]
    s1 = speed[:, 1]
    s2 = speed[:, 2]
    parabola = bernstein.through(s0**2, ((s0 + 2 * s1 + s2) / 4) ** 2, s2**2)
    # q'^2 = ... + c3 t^3 + c4 t^4; f - p = (c3 + c4 (t + 3/2)) t (t - 1/2)(t - 1), the product at
    # most sqrt(3)/36
    bend = s0 - 2 * s1 + s2
    c3 = 4 * (s1 - s0) * bend
    c4 = bend**2
    return parabola, np.sqrt(3) / 36 * (np.abs(c3 + 2 * c4) + np.abs(c4) / 2)
