"""`CellMotion`: a motion without jumps on the parts of a grid's cells, as polynomials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
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

    def part(self, first: int, last: int) -> CellMotion:
        """The parts with these numbers, the last one not included."""
        these = slice(first, last)
        return CellMotion(self.s[first : last + 1], self.x[these], self.u[these], self.slope[these])

    def taken(self, wanted: Mask, path: JointPath) -> tuple[CellMotion, JointPath]:
        """Some of the parts, put one after another, and the stretches of their path."""
        stretches = path.taken(self.s[:-1][wanted], self.s[1:][wanted])
        motion = CellMotion(stretches.knots, self.x[wanted], self.u[wanted], self.slope[wanted])
        return motion, stretches


def refined_grid(s: Array, path: JointPath) -> Array:
    """A law's grid, cut at knots and reversals of the path: that they are on it, but for rounding,
    is not taken for granted."""
    inner = s[1:-1]
    more = np.concatenate([path.knots, path.reversals()])
    more = more[(more > inner[0]) & (more < inner[-1])]
    after = np.searchsorted(s, more)
    away = np.minimum(s[after] - more, more - s[after - 1])
    more = np.unique(more[away > _SAME * s[-1]])
    apart = np.diff(more, prepend=-np.inf) > _SAME * s[-1]
    return np.sort(np.concatenate([s, more[apart]]))


def is_joined(path: JointPath) -> bool:
    """Whether q, q' and q'' are continuous at the knots: a jump of q'' would be one of the
    torque."""
    piece = np.arange(len(path.knots) - 2)
    for order in (0, 1, 2):
        before, after = (path.on_piece(path.knots[1:-1], piece + k, order) for k in (0, 1))
        if (np.abs(after - before) > _JOINED * (1 + np.abs(before).max(axis=0, initial=0.0))).any():
            return False
    return True
