"""Parabolas in place of functions of the joints on the cells of a path, and what they miss.

A parabola goes through the function's values at both ends and the middle m of a cell of half width
w. The distance of an analytic function f from it is bounded by Cauchy's integral over the circle of
radius R = kappa w about m,

    |f - p| <= 2/(3 sqrt 3) / ((kappa^2 - 1)(kappa - 1)) max_{|z - m| = R} |f(z) - f(m)|,

and the last factor by complex-disc arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure import bernstein
from irb2400_ctrl.planners.joint_path import JointMotion

# how far joints may turn on the circle of Cauchy's integral [rad]; larger: smaller factor, larger
# variation
_REACH = 0.25
_KAPPA = 400.0
# parts of that reach to try one after the other
_SHRINK = (1.0, 0.25, 1 / 16, 1 / 64)
# a bound above this says nothing
_NO_BOUND = 1e100


def parabolas(
    path: JointMotion,
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


def _remainder(
    radii: Callable[..., tuple[Array, ...]],
    path: JointMotion,
    middle: Array,
    piece: npt.NDArray[np.int64],
    w: Array,
) -> Array:
    """Cauchy's bound for every function, shape (functions, m, k)."""
    motion = tuple(path.on_piece(middle, piece, order) for order in (0, 1, 2, 3))
    R = _reach(motion)
    found = np.empty((0, len(w), 0))
    left = np.arange(len(w))
    for shrink in _SHRINK:
        kappa = np.clip(shrink * R[left] / w[left], 2.0, _KAPPA)
        at = tuple(part[left] for part in motion[:3])
        discs = path.spread(middle[left], kappa * w[left])
        bound = _cauchy(radii, at, discs, kappa)
        if not found.size:
            found = bound
        else:
            found[:, left] = np.minimum(found[:, left], bound)
        # a function that changes faster than the arm (gear ripple) has no bound on a circle this
        # large
        unbounded = bound.max(axis=(0, 2)) > _NO_BOUND
        left = left[unbounded & (kappa > 2.0)]
        if not len(left):
            break
    return found


def _reach(motion: tuple[Array, ...]) -> Array:
    """Radius of the circle about each middle within which no joint turns by more than `_REACH`,
    derivative by derivative, shape (m,) [m]."""
    _, dq, ddq, dddq = motion
    speed, curvature, third = (np.abs(d).max(axis=1) + 1e-300 for d in (dq, ddq, dddq))
    by_speed = _REACH / speed
    by_curvature = np.sqrt(_REACH / curvature)
    by_third = np.cbrt(_REACH / third)
    return np.asarray(np.minimum.reduce([by_speed, by_curvature, by_third]) / 2)


def _cauchy(
    radii: Callable[..., tuple[Array, ...]],
    motion: tuple[Array, ...],
    discs: tuple[Array, Array, Array],
    kappa: Array,
) -> Array:
    """The bound on circles of kappa half widths about the middles of the cells, where q, q' and
    q'' are given, with the discs that these stay in."""
    factor = 2 / (3 * np.sqrt(3)) / ((kappa**2 - 1) * (kappa - 1))
    return np.asarray(factor[:, None] * np.stack(radii(*motion, *discs)))
