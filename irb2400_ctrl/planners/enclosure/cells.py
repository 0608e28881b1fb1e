"""`Cells`: the torque of a path enclosed cell by cell, for every point of the path.

The path is cut so that q(s) is one cubic in each cell and no joint changes its direction inside
one. There the coefficients a, b, e, c of `path_dynamics` are replaced by parabolas through the
cell's ends and middle; the distance of an analytic function f from its parabola on a cell of half
width w is bounded by Cauchy's integral over the circle of radius R = kappa w about the middle m,

    |f - p| <= 2/(3 sqrt 3) / ((kappa^2 - 1)(kappa - 1)) max_{|z - m| = R} |f(z) - f(m)|,

and the last factor by ball arithmetic. No sample enters: what is enclosed here holds at every
instant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.enclosure.effect_bounds import Added, Range, memories
from irb2400_ctrl.planners.enclosure.path_dynamics import OUTPUTS, PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath

Array = npt.NDArray[np.float64]

# how far joints may turn on the circle of Cauchy's integral [rad]; larger: smaller factor, larger
# variation
_REACH = 0.25
_KAPPA = 400.0
# parts of that reach to try one after the other
_SHRINK = (1.0, 0.25, 1 / 16, 1 / 64)
# largest turn of a joint within a cell [rad]
_TURN = 0.03
# cells shorter than this part of their neighbours' spacing are not cut off at a reversal
_SLIVER = 1e-6


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
    forwards: npt.NDArray[np.bool_]
    backwards: npt.NDArray[np.bool_]
    """whether the joint moves in that direction somewhere in the cell, shape (m, n)"""
    curvature: Array
    """q'' at both ends (linear between), shape (m, 2, n) [rad/m2]"""
    added: Added | None = None
    """effects beside the regular form"""

    @property
    def h(self) -> Array:
        """Lengths of the cells [m], shape (m,)."""
        return np.diff(self.s)


def grid(path: JointPath, count: int) -> Array:
    """Ends of cells: knots, joint reversals, and even steps so that there are about `count` [m]."""
    turned = np.abs(np.diff(path(path.knots), axis=0)).max(axis=1)
    by_turn = np.ceil(turned / _TURN)
    by_length = np.ceil(np.diff(path.knots) / (path.length / count) - 1e-9)
    steps = np.maximum(1, np.maximum(by_length, by_turn)).astype(int)
    first = np.repeat(path.knots[:-1], steps)
    number = np.arange(steps.sum()) - np.repeat(np.cumsum(steps) - steps, steps)
    even = np.append(first + number * np.repeat(np.diff(path.knots) / steps, steps), path.knots[-1])
    return with_reversals(path, even)


def with_reversals(path: JointPath, s: Array) -> Array:
    """The grid with the zeros of every q_j'(s) added, unless they are next to a grid point."""
    roots = reversals(path)
    s = np.unique(np.concatenate([s, roots]))
    knots = set(path.knots.tolist())
    gap = np.diff(s)
    tiny = np.flatnonzero(gap < _SLIVER * np.median(gap))
    # of two points that fall together the knot stays: the polynomial changes there
    drop = [i if s[i] not in knots else i + 1 for i in tiny]
    drop = [i for i in drop if s[i] not in knots]
    return np.delete(s, drop)


def reversals(path: JointPath) -> Array:
    """Zeros of q_j'(s) inside the pieces of the path, all joints together, sorted [m]."""
    _, c1, c2, c3 = path.coefficients
    width = np.diff(path.knots)[:, None]
    # roots of c1 + 2 c2 d + 3 c3 d^2 without cancellation
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        root = np.sqrt(c2**2 - 3 * c3 * c1)
        t = -(c2 + np.where(c2 >= 0, root, -root))
        found = np.concatenate([t / (3 * c3), c1 / t])
    inside = (found > 0) & (found < np.concatenate([width, width]))
    first = np.broadcast_to(
        np.concatenate([path.knots[:-1], path.knots[:-1]])[:, None], found.shape
    )
    return np.unique((first + found)[inside])


def parabolas(
    path: JointPath,
    s: Array,
    values: Callable[..., tuple[Array, ...]],
    radii: Callable[..., tuple[Array, ...]],
) -> tuple[list[Array], Array]:
    """Bernstein coefficients (m, 3, k) of functions of (q, q', q'') on the cells, and bounds of
    what they miss.

    Args:
        path: the joint path.
        s: ends of the cells, knots of the path included [m], shape (m + 1,).
        values: (q, q', q'') -> functions at many points.
        radii: (q, q', q'', r, r', r'') -> their radii over complex discs (`disc_function`).
    """
    m = len(s) - 1
    middle = s[:-1] + np.diff(s) / 2
    piece = path.piece(middle)
    # one-sided values: every cell is evaluated on its own polynomial piece
    at = np.concatenate([s[:-1], middle, s[1:]])
    pieces = np.concatenate([piece, piece, piece])
    found = values(*(path.on_piece(at, pieces, order) for order in (0, 1, 2)))
    fitted = [bernstein.through(*f.reshape(3, m, -1)) for f in found]
    return fitted, _remainder(radii, path, middle, piece, np.diff(s) / 2)


def enclose(dynamics: PathDynamics, path: JointPath, s: Array) -> Cells:
    """The enclosure on the cells between the lengths s (knots of the path included)."""
    fitted, remainder = parabolas(path, s, dynamics.coefficients, dynamics.radii)
    low, high = dynamics.factors
    a, b, e = fitted[:3]
    # what factors of the time add, coefficient by coefficient: the remainders simply add up
    count = len(OUTPUTS)
    size = np.maximum(np.abs(low), np.abs(high))
    timed = [[fitted[count * (k + 1) + i] for k in range(len(low))] for i in range(count)]
    rest = np.array(remainder[:count])
    for k, g in enumerate(size):
        rest += g * remainder[count * (k + 1) : count * (k + 2)]
    ranges = [Range.of(parts, low, high) for parts in timed] if len(low) else []
    c_below = list(fitted[3:6])
    c_above = list(fitted[3:6])
    for i, found in enumerate(ranges[3:]):
        c_below[i] = c_below[i] + found.low
        c_above[i] = c_above[i] + found.high
    piece = path.piece(s[:-1] + np.diff(s) / 2)
    ends = [(path.on_piece(at, piece, 1), path.on_piece(at, piece, 2)) for at in (s[:-1], s[1:])]
    (first, curved), (last, curved_last) = ends
    # q' is a parabola
    speed = bernstein.leaving(first, curved * np.diff(s)[:, None], last)
    # at a reversal that ends the cell q' is zero up to rounding: that is no motion the other way
    noise = 1e-9 * bernstein.largest_size(speed)
    slowest, fastest = bernstein.hull(speed)
    forwards = fastest > noise
    backwards = slowest < -noise
    still = ~(forwards ^ backwards)
    c_high = np.full_like(a, -np.inf)
    c_low = np.full_like(a, np.inf)
    for used, below, above in zip((backwards, still, forwards), c_below, c_above, strict=True):
        c_high = np.where(used[:, None], np.maximum(c_high, above), c_high)
        c_low = np.where(used[:, None], np.minimum(c_low, below), c_low)
    together = np.stack([*rest[:3], rest[3:].max(axis=0)])
    curvature = bernstein.linear(curved, curved_last)
    added = None
    if ranges or dynamics.forms.laws:
        nothing = Range(np.zeros_like(a), np.zeros_like(a))
        load = fitted[-3:]
        load_rest = remainder[-3:]
        if not dynamics.needs_load:
            load = [np.empty(0)] * 3
            load_rest = np.empty((3, 0, 0))
        direction = (
            np.where(backwards, -1.0, np.where(forwards, 1.0, 0.0)),
            np.where(forwards, 1.0, np.where(backwards, -1.0, 0.0)),
        )
        a_range, b_range, e_range = ranges[:3] or [nothing] * 3
        square, missed = _square(speed)
        added = Added(
            a=a_range,
            b=b_range,
            e=e_range,
            laws=dynamics.forms.laws,
            direction=direction,
            states=memories(dynamics.forms.laws, path(s), direction),
            load=(load[0], load[1], load[2]),
            load_remainder=load_rest,
            square=square,
            square_remainder=missed,
        )
    return Cells(s, a, b, e, c_low, c_high, together, speed, forwards, backwards, curvature, added)


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


def _remainder(
    radii: Callable[..., tuple[Array, ...]],
    path: JointPath,
    middle: Array,
    piece: npt.NDArray[np.int64],
    w: Array,
) -> Array:
    """Cauchy's bound for every function, shape (functions, m, k)."""
    q, dq, ddq, dddq = (path.on_piece(middle, piece, order) for order in (0, 1, 2, 3))
    size = [np.abs(d).max(axis=1) + 1e-300 for d in (dq, ddq, dddq)]
    R = (
        np.minimum.reduce([_REACH / size[0], np.sqrt(_REACH / size[1]), np.cbrt(_REACH / size[2])])
        / 2
    )
    found = np.empty((0, len(w), 0))
    left = np.arange(len(w))
    for shrink in _SHRINK:
        kappa = np.clip(shrink * R[left] / w[left], 2.0, _KAPPA)
        bound = _cauchy(radii, (q[left], dq[left], ddq[left], dddq[left]), kappa, w[left])
        if not found.size:
            found = bound
        else:
            found[:, left] = np.minimum(found[:, left], bound)
        # a function that changes faster than the arm (gear ripple) has no bound on a circle this
        # large
        left = left[(bound.max(axis=(0, 2)) > 1e100) & (kappa > 2.0)]
        if not len(left):
            break
    return found


def _cauchy(
    radii: Callable[..., tuple[Array, ...]], path: tuple[Array, ...], kappa: Array, w: Array
) -> Array:
    """The bound on circles of radius kappa w about the middles of the cells, where q and its
    derivatives are given."""
    q, dq, ddq, dddq = path
    R = (kappa * w)[:, None]
    r = np.abs(dq) * R + np.abs(ddq) * R**2 / 2 + np.abs(dddq) * R**3 / 6
    dr = np.abs(ddq) * R + np.abs(dddq) * R**2 / 2
    ddr = np.abs(dddq) * R
    factor = 2 / (3 * np.sqrt(3)) / ((kappa**2 - 1) * (kappa - 1))
    return np.asarray(factor[:, None] * np.stack(radii(q, dq, ddq, r, dr, ddr)))
