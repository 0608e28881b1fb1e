"""`JointPath`: joint angles as a cubic spline over the length of the path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError


@dataclass(frozen=True)
class JointPath:
    """q(s), twice continuously differentiable, a cubic in s - s_k between the knots s_k."""

    knots: Array
    """lengths along the path [m], increasing, shape (m + 1,)"""
    coefficients: Array
    """q(s) = sum_p coefficients[p, k] (s - s_k)^p, shape (4, m, n)"""

    def __post_init__(self) -> None:
        m = len(self.knots) - 1
        if m < 1 or self.coefficients.shape[:2] != (4, m) or not (np.diff(self.knots) > 0).all():
            raise InputError(
                f"joint path: found {len(self.knots)} knots and coefficients "
                f"{self.coefficients.shape}, "
                "expected increasing knots and shape (4, knots - 1, n)"
            )
        self.knots.setflags(write=False)
        self.coefficients.setflags(write=False)

    @classmethod
    def through(cls, s: Array, q: Array) -> JointPath:
        """The interpolating spline through q (m, n) [rad] at lengths s (m,) (not-a-knot ends)."""
        from scipy.interpolate import CubicSpline

        # too few points for not-a-knot: straight in joint space for two, natural for three
        spline = CubicSpline(s, q, bc_type="natural" if len(s) < 4 else "not-a-knot")
        return cls(np.array(s, dtype=float), np.ascontiguousarray(spline.c[::-1]))

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.coefficients.shape[2])

    @property
    def length(self) -> float:
        """Total length [m]."""
        return float(self.knots[-1] - self.knots[0])

    def piece(self, s: Array) -> npt.NDArray[np.int64]:
        """Number of the polynomial piece that each s lies in."""
        return np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.knots) - 2)

    def __call__(self, s: Array, order: int = 0) -> Array:
        """The derivative of the given order by s, shape (k, n) [rad/m^order]."""
        s = np.atleast_1d(np.asarray(s, dtype=float))
        return self.on_piece(s, self.piece(s), order)

    def on_piece(self, s: Array, piece: npt.NDArray[np.int64], order: int = 0) -> Array:
        """The same with the polynomial piece chosen by the caller (for one-sided values at
        knots)."""
        d = (s - self.knots[piece])[:, None]
        c0, c1, c2, c3 = self.coefficients[:, piece]
        if order == 0:
            value = c0 + d * (c1 + d * (c2 + d * c3))
        elif order == 1:
            value = c1 + d * (2 * c2 + d * (3 * c3))
        elif order == 2:
            value = 2 * c2 + d * (6 * c3)
        else:
            value = 6 * c3
        return np.asarray(value)
