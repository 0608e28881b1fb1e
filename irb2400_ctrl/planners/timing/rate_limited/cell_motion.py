"""`CellMotion`: a motion without jumps on the parts of a grid's cells, as polynomials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.joint_path import JointPath

# the pieces of a path may disagree by rounding
_JOINED = 1e-7
# points of a grid that are no farther from each other, as a part of its length, are one: what is
# divided by the width of a part between them is rounding
_SAME = 1e-12


@dataclass(frozen=True)
class CellMotion:
    """x quadratic and u linear in s on every part.

    The end parts are of constant jerk instead: for them x stands for its largest value, u for its
    values at both ends, and the slope for the jerk over the largest speed.
    """

    s: Array
    """ends of the parts [m], shape (m + 1,)"""
    x: Array
    """Bernstein coefficients of sdot^2, shape (m, 3) [m2/s2]"""
    u: Array
    """Bernstein coefficients of sddot, shape (m, 2) [m/s2]"""
    slope: Array
    """du/ds, shape (m,) [1/s2]"""


def refined_grid(s: Array, path: JointPath, parts: int) -> Array:
    """A law's grid with its inner cells cut into equal parts, and at knots and reversals of the
    path: that they are on the law's grid, but for rounding, is not taken for granted."""
    inner = s[1:-1]
    split = (inner[:-1, None] + np.arange(parts) / parts * np.diff(inner)[:, None]).ravel()
    more = np.concatenate([path.knots, path.reversals()])
    more = more[(more > inner[0]) & (more < inner[-1])]
    own = np.unique(np.concatenate([s, split]))
    after = np.searchsorted(own, more)
    away = np.minimum(own[after] - more, more - own[after - 1])
    more = np.unique(more[away > _SAME * own[-1]])
    apart = np.diff(more, prepend=-np.inf) > _SAME * own[-1]
    return np.sort(np.concatenate([own, more[apart]]))


def is_joined(path: JointPath) -> bool:
    """Whether q, q' and q'' are continuous at the knots: a jump of q'' would be one of the
    torque."""
    piece = np.arange(len(path.knots) - 2)
    for order in (0, 1, 2):
        before, after = (path.on_piece(path.knots[1:-1], piece + k, order) for k in (0, 1))
        if (np.abs(after - before) > _JOINED * (1 + np.abs(before).max(axis=0, initial=0.0))).any():
            return False
    return True
