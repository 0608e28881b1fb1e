"""`Trajectory`: a motion sampled in time, at any rate with continuous acceleration."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import InitVar, dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers
from irb2400_ctrl.typed import typed

RATE = 250.0
"""rows of a motion per second, unless asked otherwise: what EGM takes [1/s]"""
# rows that are written at once
_ROWS = 1000
# significant digits of the arrays in the file, and those of its angles
_DIGITS = {"time": 12, "q": 14, "qd": 12, "qdd": 9, "tau": 9, "s": 12}
_MOVES = ("q", "qd", "qdd")
# numbers whose decimals are found by scaling
_USUAL = (1e-7, 1e7)


@typed
@dataclass(frozen=True, eq=False, repr=False)
class Trajectory:
    """A motion sampled in time; all arrays are read-only.

    Args:
        check_speeds: refuse speeds that do not lead from row to row. Off for rows of a known law,
            which may be as far apart as one likes; `at_rate` refuses those that are too far.

    Raises:
        InputError: shapes differ, a number is not finite, time does not increase, speeds and angles
            are of different motions or units.
    """

    time: Array
    """[s], shape (n,), increasing"""
    q: Array
    qd: Array
    qdd: Array
    """[rad], [rad/s], [rad/s2], shape (n, axes)"""
    tau: Array | None = None
    """torque of the model along it, friction and effects included [Nm], shape (n, axes)"""
    s: Array | None = None
    """how far along its path: length of the TCP's way [m], or the path's parameter; shape (n,)"""
    external: Trajectory | None = field(default=None, kw_only=True)
    """at the same times, axes beside the arm that carry it or the part; None where none moves"""
    lengths: tuple[int, ...] = field(default=(), kw_only=True)
    """columns of rails: metres in place of radians, mm in the file"""
    check_speeds: InitVar[bool] = field(default=True, kw_only=True)

    def __post_init__(self, check_speeds: bool) -> None:
        for name in ("time", "q", "qd", "qdd", "tau", "s"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _frozen(getattr(self, name)))
        self._check_shapes()
        for name in _DIGITS:
            values = getattr(self, name)
            if values is not None and not np.isfinite(values).all():
                row = int(np.argwhere(~np.isfinite(values))[0, 0])
                raise InputError(
                    f"trajectory: found NaN or infinite values ({name}, first in row {row + 1}); "
                    "expected finite numbers"
                )
        steps = np.diff(self.time)
        if (steps <= 0).any():
            row = int(np.argmax(steps <= 0))
            raise InputError(
                f"trajectory: time does not increase at row {row + 2} ({self.time[row + 1]} s)"
            )
        if check_speeds:
            self._check_speeds()

    def _check_shapes(self) -> None:
        n = len(self.time) if self.time.ndim == 1 else 0
        if n < 1 or self.q.ndim != 2 or not self.q.shape == self.qd.shape == self.qdd.shape:
            raise InputError(
                f"trajectory: found time {self.time.shape}, q {self.q.shape}, qd {self.qd.shape}, "
                f"qdd {self.qdd.shape}; expected (n,) and three times (n, axes), n >= 2"
            )
        if len(self.q) != n:
            raise InputError(
                f"trajectory: found {n} times and {len(self.q)} rows of angles; expected as many"
            )
        if self.tau is not None and self.tau.shape != self.q.shape:
            raise InputError(
                f"trajectory: found torques {self.tau.shape}; expected {self.q.shape} as the angles"
            )
        if self.s is not None and self.s.shape != (n,):
            raise InputError(f"trajectory: found s {self.s.shape}; expected ({n},) as the times")
        if self.external is not None and not np.array_equal(self.external.time, self.time):
            raise InputError("trajectory: found external axes at other times than the arm's")

    def _check_speeds(self) -> None:
        steps = np.diff(self.time)
        moved = np.diff(self.q, axis=0)
        mean = 0.5 * (self.qd[1:] + self.qd[:-1]) * steps[:, None]
        # the trapezoid misses h^2/8 of the acceleration's change; more than that is another unit or
        # another motion
        allowed = (
            1e-3
            + 0.5 * np.abs(moved)
            + (np.abs(self.qdd[1:]) + np.abs(self.qdd[:-1])) * steps[:, None] ** 2
        )
        if (np.abs(moved - mean) > allowed).any():
            row, axis = np.argwhere(np.abs(moved - mean) > allowed)[0]
            raise InputError(
                f"trajectory: axis {axis + 1} moves by {moved[row, axis] / self._unit[axis]:.3f} "
                f"{self._units[axis]} in row {row + 2}, its speeds say "
                f"{mean[row, axis] / self._unit[axis]:.3f} {self._units[axis]}; check units and "
                "columns, or sample it more often"
            )

    def __repr__(self) -> str:
        rows, joints = self.q.shape
        return f"<Trajectory: {rows} rows of {joints} joints, {self.duration:.3f} s>"

    @property
    def duration(self) -> float:
        """Time from first to last sample [s]."""
        return float(self.time[-1] - self.time[0])

    @typed
    def at_rate(self, rate: float, *, hold: float = 0.0) -> Trajectory:
        """The motion at `rate` [Hz] from time 0, by quintic Hermite interpolation (angle C2
        everywhere).

        Args:
            hold: time [s] for which the last pose is held at the end.

        Torque and way belong to the rows they were computed at and are left out.

        Raises:
            InputError: fewer than two rows, or rows so far apart that nothing says what is between.
        """
        self.check_moves()
        self._check_speeds()
        count = math.floor((self.duration + hold) * rate + 1e-6) + 1
        time = np.arange(count) / rate
        inside = np.minimum(time, self.duration)
        q, qd, qdd = _quintic(self.time - self.time[0], self.q, self.qd, self.qdd, inside)
        over = time > self.duration + 1e-9
        qd[over] = 0.0
        qdd[over] = 0.0
        return Trajectory(time, q, qd, qdd)

    def check_moves(self) -> None:
        """Refuse a single row, which is a pose and no motion.

        Raises:
            InputError: fewer than two rows.
        """
        if len(self.time) < 2:
            raise InputError(
                f"trajectory: found time {self.time.shape}, q {self.q.shape}, qd {self.qd.shape}, "
                f"qdd {self.qdd.shape}; expected (n,) and three times (n, axes), n >= 2"
            )

    def as_written(self) -> Trajectory:
        """The same rows with the digits that `csv` keeps: what is read from the file."""
        found: dict[str, Array] = {}
        for name, _ in self._widths:
            values = self._shown(name)
            for column in values.T:
                column[:] = rounded(column, _DIGITS[name])
            if name in _MOVES:
                values *= self._unit
            values.setflags(write=False)
            found[name] = values.reshape(getattr(self, name).shape)
        external = None if self.external is None else self.external.as_written()
        return Trajectory(**found, external=external, lengths=self.lengths, check_speeds=False)

    @property
    def shown(self) -> Array:
        """The angles in degrees; places of rails in mm."""
        return np.asarray(self.q / self._unit)

    @property
    def _unit(self) -> Array:
        """Of the file's numbers in those of the arrays, shape (axes,)."""
        unit = np.full(self.q.shape[1], math.pi / 180)
        unit[list(self.lengths)] = 1e-3
        return unit

    def together(self) -> Trajectory:
        """The angles of the arm and of external axes side by side, without torque and way."""
        if self.external is None:
            return self
        pairs = ((self.q, self.external.q), (self.qd, self.external.qd))
        q, qd = (np.hstack(pair) for pair in pairs)
        qdd = np.hstack([self.qdd, self.external.qdd])
        lengths = tuple(self.q.shape[1] + j for j in self.external.lengths)
        return Trajectory(self.time, q, qd, qdd, lengths=lengths, check_speeds=False)

    def apart(self, n: int) -> Trajectory:
        """`together` taken apart again: the first n axes are the arm's."""
        if n == self.q.shape[1]:
            return self
        moves = (self.q, self.qd, self.qdd)
        further = (v[:, n:] for v in moves)
        lengths = tuple(j - n for j in self.lengths)
        rest = Trajectory(self.time, *further, lengths=lengths, check_speeds=False)
        arm = (v[:, :n] for v in moves)
        return Trajectory(self.time, *arm, external=rest, check_speeds=False)

    def csv(self) -> str:
        """The text of `trajectory.csv`, see `csv_parts`."""
        return "".join(self.csv_parts())

    def csv_parts(self) -> Iterator[str]:
        """The text of `trajectory.csv`: degrees, Nm, and s as it is; tau and s only where known;
        in the end e1_deg … of external axes where such move (e1_mm of a rail).

        Angles and speeds keep more digits than anybody measures: between rows h apart a cubic
        through them has the rounding of an angle times 6 / h^2 in its acceleration.
        """
        n = self.q.shape[1]
        names = [("q", "_deg"), ("qd", "_deg_s"), ("qdd", "_deg_s2")]
        if self.tau is not None:
            names.append(("tau", "_Nm"))
        header = ["time_s", *(f"{name}{j + 1}{unit}" for name, unit in names for j in range(n))]
        if self.s is not None:
            header.append("s")
        moving = self.external
        digits = [_DIGITS[name] for name, width in self._widths for _ in range(width)]
        if moving is not None:
            header += [
                f"e{name[1:]}{j + 1}_{unit}{per}"
                for name, per in (("q", ""), ("qd", "_s"), ("qdd", "_s2"))
                for j, unit in enumerate(moving._units)
            ]
            digits += [_DIGITS[name] for name, width in moving._widths[1:] for _ in range(width)]
        line = ",".join(f"%.{d}g" for d in digits) + "\n"
        yield ",".join(header) + "\n"
        for first in range(0, len(self.time), _ROWS):
            rows = slice(first, first + _ROWS)
            columns = [self._shown(name, rows) for name, _ in self._widths]
            if moving is not None:
                columns += [moving._shown(name, rows) for name, _ in moving._widths[1:]]
            table = np.hstack(columns)
            yield line * len(table) % tuple(table.ravel().tolist())

    @property
    def _units(self) -> list[str]:
        """Of each axis in the file."""
        return ["mm" if j in self.lengths else "deg" for j in range(self.q.shape[1])]

    @property
    def _widths(self) -> list[tuple[str, int]]:
        """Names of the arrays that the file has, time first, and how many columns each takes."""
        known = [(name, getattr(self, name)) for name in _DIGITS]
        return [(name, math.prod(v.shape[1:])) for name, v in known if v is not None]

    def _shown(self, name: str, rows: slice = slice(None)) -> Array:
        """The numbers of the file, a row each; a new array."""
        values = getattr(self, name)[rows]
        if name in _MOVES:
            values = values / self._unit
        # adding zero takes the sign from a negative zero
        return np.asarray(0.0 + values.reshape(len(values), -1))


def _frozen(values: ArrayLike) -> Array:
    """The numbers as an array that nobody writes to: themselves, where they are one, else a
    copy."""
    if isinstance(values, np.ndarray) and values.dtype == np.float64 and values.flags.c_contiguous:
        owner: object = values
        while isinstance(owner, np.ndarray) and not owner.flags.writeable:
            owner = owner.base
        if owner is None:
            return values
    array = np.array(numbers("trajectory", values))
    array.setflags(write=False)
    return array


def rounded(values: Array, digits: int) -> Array:
    """The values with so many significant digits, to the last bit those that are read back from
    the text of `%.{digits}g`."""
    size = np.abs(values)
    found = values.copy()
    usual = (size >= _USUAL[0]) & (size < _USUAL[1])
    x = size[usual]
    exponent = np.floor(np.log10(x)).astype(int)
    # whole numbers below 2^53 and powers of ten up to 1e22 are exact, and so is their quotient
    scale = 10.0 ** (digits - 1 - exponent)
    whole = np.round(x * scale)
    found[usual] = np.copysign(whole / scale, values[usual])
    # near the middle between two decimals the product, below 10^digits, may be rounded to the
    # other one: by half a unit of its last bit
    miss = 10.0**digits * np.finfo(float).eps
    doubtful = np.abs(x * scale - np.floor(x * scale) - 0.5) < miss
    rest = np.flatnonzero(~usual & (size > 0))
    for at in [*np.flatnonzero(usual)[doubtful], *rest]:
        found[at] = float(f"{values[at]:.{digits}g}")
    return found


@typed
def from_angles(time: ArrayLike, q: ArrayLike) -> Trajectory:
    """A trajectory from angles alone: cubic spline (C2) that starts and ends at rest.

    Args:
        time: [s], shape (n,).
        q: angles [rad], shape (n, axes).
    """
    from scipy.interpolate import CubicSpline

    t = numbers("time", time)
    angles = numbers("q", q)
    if t.ndim != 1 or angles.ndim != 2 or len(t) != len(angles) or len(t) < 3:
        raise InputError(
            f"trajectory: found time {t.shape}, q {angles.shape}; expected (n,), (n, axes), n >= 3"
        )
    # says which row is none
    Trajectory(t, angles, np.zeros_like(angles), np.zeros_like(angles), check_speeds=False)
    spline = CubicSpline(t, angles, bc_type="clamped")
    return Trajectory(t, angles, spline(t, 1), spline(t, 2))


def _quintic(t: Array, q: Array, qd: Array, qdd: Array, at: Array) -> tuple[Array, Array, Array]:
    """Value and two derivatives at the times `at` of the piecewise quintic through q, qd, qdd at
    the times t."""
    k = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    h = (t[k + 1] - t[k])[:, None]
    s = (at - t[k])[:, None] / h
    p0 = q[k]
    v0 = h * qd[k]
    a0 = h**2 * qdd[k]
    p1 = q[k + 1]
    v1 = h * qd[k + 1]
    a1 = h**2 * qdd[k + 1]
    d = p1 - p0
    c3 = 10 * d - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1
    c4 = -15 * d + 8 * v0 + 7 * v1 + 1.5 * a0 - a1
    c5 = 6 * d - 3 * (v0 + v1) - 0.5 * (a0 - a1)
    value = p0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5))))
    first = v0 + s * (a0 + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))
    second = a0 + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))
    return value, first / h, second / h**2
