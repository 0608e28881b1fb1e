"""`Cells`: the torque of a path enclosed cell by cell, for every point of the path.

The path is cut so that q(s) is one cubic in each cell and no joint changes its direction inside one. There the
coefficients a, b, e, c of `path_dynamics` are replaced by parabolas through the cell's ends and middle; the distance of
an analytic function f from its parabola on a cell of half width w is bounded by Cauchy's integral over the circle of
radius R = kappa w about the middle m,

    |f - p| <= 2/(3 sqrt 3) / ((kappa^2 - 1)(kappa - 1)) max_{|z - m| = R} |f(z) - f(m)|,

and the last factor by ball arithmetic. No sample enters: what is enclosed here holds at every instant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.path_dynamics import PathDynamics

Array = npt.NDArray[np.float64]

# how far joints may turn on the circle of Cauchy's integral [rad]; larger: smaller factor, larger variation
_REACH = 0.25
_KAPPA = 400.0
# largest turn of a joint within a cell [rad]
_TURN = 0.03
# cells shorter than this part of their neighbours' spacing are not cut off at a reversal
_SLIVER = 1e-6


@dataclass(frozen=True)
class Cells:
    """Coefficients on m cells of an n-joint path, as Bernstein coefficients of degree 2 (second axis)."""

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
    first = np.broadcast_to(np.concatenate([path.knots[:-1], path.knots[:-1]])[:, None], found.shape)
    return np.unique((first + found)[inside])


def parabolas(
    path: JointPath, s: Array, values: Callable[..., tuple[Array, ...]], radii: Callable[..., tuple[Array, ...]]
) -> tuple[list[Array], Array]:
    """Bernstein coefficients (m, 3, k) of functions of (q, q', q'') on the cells, and bounds of what they miss.

    Args:
        path: the joint path.
        s: ends of the cells, knots of the path included [m], shape (m + 1,).
        values: (q, q', q'') -> functions at many points.
        radii: (q, q', q'', r, r', r'') -> their radii over complex balls (`ball_function`).
    """
    m = len(s) - 1
    middle = s[:-1] + np.diff(s) / 2
    piece = path.piece(middle)
    # one-sided values: every cell is evaluated on its own polynomial piece
    at, pieces = np.concatenate([s[:-1], middle, s[1:]]), np.concatenate([piece, piece, piece])
    found = values(*(path.on_piece(at, pieces, order) for order in (0, 1, 2)))
    bernstein = [_bernstein(f.reshape(3, m, -1)) for f in found]
    return bernstein, _remainder(radii, path, middle, piece, np.diff(s) / 2)


def enclose(dynamics: PathDynamics, path: JointPath, s: Array) -> Cells:
    """The enclosure on the cells between the lengths s (knots of the path included)."""
    fitted, remainder = parabolas(path, s, dynamics.coefficients, dynamics.radii)
    a, b, e, c_minus, c_zero, c_plus = fitted
    r_a, r_b, r_e, r_minus, r_zero, r_plus = remainder
    piece = path.piece(s[:-1] + np.diff(s) / 2)
    ends = [(path.on_piece(at, piece, 1), path.on_piece(at, piece, 2)) for at in (s[:-1], s[1:])]
    (first, curved), (last, curved_last) = ends
    # q' is a parabola: its middle Bernstein coefficient follows the tangent at the start
    speed = np.stack([first, first + curved * np.diff(s)[:, None] / 2, last], axis=1)
    # at a reversal that ends the cell q' is zero up to rounding: that is no motion the other way
    noise = 1e-9 * np.abs(speed).max(axis=1)
    forwards, backwards = speed.max(axis=1) > noise, speed.min(axis=1) < -noise
    still = ~(forwards ^ backwards)
    c_high, c_low = np.full_like(c_zero, -np.inf), np.full_like(c_zero, np.inf)
    for used, c in ((forwards, c_plus), (backwards, c_minus), (still, c_zero)):
        c_high = np.where(used[:, None], np.maximum(c_high, c), c_high)
        c_low = np.where(used[:, None], np.minimum(c_low, c), c_low)
    rest = np.stack([r_a, r_b, r_e, np.maximum(np.maximum(r_minus, r_plus), r_zero)])
    curvature = np.stack([curved, curved_last], axis=1)
    return Cells(s, a, b, e, c_low, c_high, rest, speed, forwards, backwards, curvature)


def _bernstein(values: Array) -> Array:
    """Bernstein coefficients (m, 3, n) of the parabolas through values at start, middle and end (3, m, n)."""
    first, middle, last = values
    return np.stack([first, 2 * middle - (first + last) / 2, last], axis=1)


def _remainder(
    radii: Callable[..., tuple[Array, ...]], path: JointPath, middle: Array, piece: npt.NDArray[np.int64], w: Array
) -> Array:
    """Cauchy's bound for every function, shape (functions, m, k)."""
    q, dq, ddq, dddq = (path.on_piece(middle, piece, order) for order in (0, 1, 2, 3))
    size = [np.abs(d).max(axis=1) + 1e-300 for d in (dq, ddq, dddq)]
    R = np.minimum.reduce([_REACH / size[0], np.sqrt(_REACH / size[1]), np.cbrt(_REACH / size[2])]) / 2
    kappa = np.clip(R / w, 2.0, _KAPPA)
    R = (kappa * w)[:, None]
    r = np.abs(dq) * R + np.abs(ddq) * R**2 / 2 + np.abs(dddq) * R**3 / 6
    dr = np.abs(ddq) * R + np.abs(dddq) * R**2 / 2
    ddr = np.abs(dddq) * R
    factor = 2 / (3 * np.sqrt(3)) / ((kappa**2 - 1) * (kappa - 1))
    return np.asarray(factor[:, None] * np.stack(radii(q, dq, ddq, r, dr, ddr)))
