"""`RateLimitedLaw`: when the path is where, without a jump of the acceleration from rest to
rest."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.planners.joint_path import JointPath

Array = npt.NDArray[np.float64]

# below this |beta| t^2 the series is exact to rounding
_SERIES = 1e-2


@dataclass(frozen=True)
class RateLimitedLaw:
    """s(t) with sddot = u continuous, linear in s between the grid points, and of constant jerk in
    the end cells.

    Inside a cell u = u_i + beta (s - s_i): a hyperbolic, or harmonic, motion in closed form. At an
    end u grows as the cube root of s, which no straight line follows: there s = h (t / T)^3 within
    the first cell, which asks for x_1 = 3 h u_1 / 2, and likewise backwards in the last one.
    """

    s: Array
    """grid [m], shape (m + 1,), m > 2"""
    x: Array
    """sdot^2 at the grid points [m2/s2], zero at both ends, shape (m + 1,)"""
    u: Array
    """sddot at the grid points [m/s2], zero at both ends, shape (m + 1,); x_{i+1} - x_i = h (u_i +
    u_{i+1}) inside"""

    def __post_init__(self) -> None:
        for array in (self.s, self.x, self.u):
            array.setflags(write=False)

    @cached_property
    def slope(self) -> Array:
        """beta = du/ds in each cell, shape (m,) [1/s2]; not used in the end cells."""
        return np.asarray(np.diff(self.u) / np.diff(self.s))

    @property
    def largest(self) -> Array:
        """Upper bound of sdot^2 in each cell, shape (m,)."""
        ends = np.maximum(self.x[:-1], self.x[1:])
        middle = self.x[:-1] + np.diff(self.s) * self.u[:-1]
        middle[[0, -1]] = 0.0
        return np.maximum(ends, middle)

    @cached_property
    def time(self) -> Array:
        """When the grid points are passed [s], shape (m + 1,)."""
        v = np.sqrt(self.x)
        h = np.diff(self.s)
        # h / (v_i + v_{i+1}) = tanh(omega dt / 2) / omega with omega^2 = beta, or tan for a
        # negative one
        half = h / (v[:-1] + v[1:])
        step = 2 * half * _arc(self.slope * half**2)
        step[0] = 3 * h[0] / v[1]
        step[-1] = 3 * h[-1] / v[-2]
        return np.concatenate([[0.0], np.cumsum(step)])

    @property
    def duration(self) -> float:
        """[s]"""
        return float(self.time[-1])

    def on(self, s: Array) -> tuple[Array, Array]:
        """x and u at lengths between the end cells, or at the ends, shapes of s."""
        cell = np.clip(np.searchsorted(self.s, s, side="right") - 1, 1, len(self.s) - 3)
        d = s - self.s[cell]
        x = self.x[cell] + d * (2 * self.u[cell] + self.slope[cell] * d)
        at_end = (s <= self.s[0]) | (s >= self.s[-1])
        return np.where(at_end, 0.0, x), np.where(at_end, 0.0, self.u[cell] + self.slope[cell] * d)

    def slowed(self, factor: float) -> RateLimitedLaw:
        """The same motion that takes `factor` times as long."""
        return RateLimitedLaw(self.s, self.x / factor**2, self.u / factor**2)

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """(s, sdot, sddot) at the given times; before the start and after the end the path stands
        still."""
        inside = np.clip(time, 0.0, self.duration)
        last = len(self.s) - 2
        cell = np.clip(np.searchsorted(self.time, inside, side="right") - 1, 0, last)
        t = inside - self.time[cell]
        v = np.sqrt(self.x[cell])
        u = self.u[cell]
        beta = np.where((cell == 0) | (cell == last), 0.0, self.slope[cell])
        C, S1, S2 = _motions(beta, t)
        s = self.s[cell] + v * S1 + u * S2
        speed = v * C + u * S1
        acceleration = u * C + beta * v * S1
        for end, sign, rest in ((0, 1.0, inside), (last, -1.0, self.duration - inside)):
            h = self.s[end + 1] - self.s[end]
            T = self.time[end + 1] - self.time[end]
            part = np.maximum(rest, 0.0) / T
            start = self.s[0] if end == 0 else self.s[-1]
            here = cell == end
            s = np.where(here, start + sign * h * part**3, s)
            speed = np.where(here, 3 * h / T * part**2, speed)
            acceleration = np.where(here, sign * 6 * h / T**2 * part, acceleration)
        over = (time >= self.duration) | (time < 0)
        s = np.clip(s, self.s[cell], self.s[cell + 1])
        return s, np.where(over, 0.0, np.maximum(speed, 0.0)), np.where(over, 0.0, acceleration)

    def motion(self, path: JointPath, time: Array) -> tuple[Array, Array, Array, Array]:
        """(s, q, qd, qdd) at the given times; shapes (k,) and (k, n)."""
        s, v, u = self.at(time)
        first = path(s, 1)
        second = path(s, 2)
        return s, path(s), first * v[:, None], second * v[:, None] ** 2 + first * u[:, None]


def _arc(z: Array) -> Array:
    """artanh(sqrt z) / sqrt z, and arctan(sqrt -z) / sqrt -z for negative z."""
    root = np.sqrt(np.abs(z))
    safe = np.where(np.abs(z) < _SERIES, 1.0, root)
    far = (
        np.where(
            z > 0, np.arctanh(np.minimum(safe, 1 - 1e-16) * (np.abs(z) >= _SERIES)), np.arctan(safe)
        )
        / safe
    )
    series = np.zeros_like(z)
    for k in range(8, -1, -1):
        series = series * z + 1 / (2 * k + 1)
    return np.asarray(np.where(np.abs(z) < _SERIES, series, far))


def _motions(beta: Array, t: Array) -> tuple[Array, Array, Array]:
    """cosh(w t), sinh(w t) / w and (cosh(w t) - 1) / w^2 with w^2 = beta of either sign."""
    z = beta * t**2
    root = np.sqrt(np.abs(z))
    near = np.abs(z) < _SERIES
    safe = np.where(near, 1.0, root)
    square = np.where(near, 1.0, z)
    C = np.where(z > 0, np.cosh(root), np.cos(root))
    S1 = np.where(z > 0, np.sinh(safe), np.sin(safe)) / safe
    S2 = 2 * np.where(z > 0, np.sinh(safe / 2), np.sin(safe / 2)) ** 2 / np.abs(square)
    first = 1.0
    second = 0.5
    series1 = np.zeros_like(z)
    series2 = np.zeros_like(z)
    terms1 = [first]
    terms2 = [second]
    for k in range(1, 8):
        first /= 2 * k * (2 * k + 1)
        second /= (2 * k + 1) * (2 * k + 2)
        terms1.append(first)
        terms2.append(second)
    for p, r in zip(reversed(terms1), reversed(terms2), strict=True):
        series1 = series1 * z + p
        series2 = series2 * z + r
    return C, t * np.where(near, series1, S1), t**2 * np.where(near, series2, S2)
