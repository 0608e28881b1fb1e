"""Reference motions: read, checked, and brought to the control rate with continuous
acceleration."""

from __future__ import annotations

import csv
import gzip
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A motion sampled in time: `time` (n,) [s], `q`, `qd`, `qdd` (n, axes) [rad, rad/s, rad/s2];
    read-only."""

    time: Array
    q: Array
    qd: Array
    qdd: Array

    def __post_init__(self) -> None:
        for name in ("time", "q", "qd", "qdd"):
            array = np.array(getattr(self, name), dtype=float)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        n = len(self.time)
        if (
            self.time.ndim != 1
            or n < 2
            or self.q.ndim != 2
            or not self.q.shape == self.qd.shape == self.qdd.shape
        ):
            raise InputError(
                f"trajectory: found time {self.time.shape}, q {self.q.shape}, qd {self.qd.shape}, "
                f"qdd {self.qdd.shape}; expected (n,) and three times (n, axes), n >= 2"
            )
        if len(self.q) != n:
            raise InputError(
                f"trajectory: found {n} times and {len(self.q)} rows of angles; expected as many"
            )
        if not all(np.isfinite(a).all() for a in (self.time, self.q, self.qd, self.qdd)):
            raise InputError("trajectory: found NaN or infinite values; expected finite numbers")
        steps = np.diff(self.time)
        if (steps <= 0).any():
            row = int(np.argmax(steps <= 0))
            raise InputError(
                f"trajectory: time does not increase at row {row + 2} ({self.time[row + 1]} s)"
            )
        self._check_speed(steps)

    def _check_speed(self, steps: Array) -> None:
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
                f"trajectory: axis {axis + 1} moves by {math.degrees(moved[row, axis]):.3f} deg in "
                f"row {row + 2}, its "
                f"speeds say {math.degrees(mean[row, axis]):.3f} deg; check units and columns"
            )

    @property
    def duration(self) -> float:
        """Time from first to last sample [s]."""
        return float(self.time[-1] - self.time[0])

    def at_rate(self, rate: float, *, hold: float = 0.0) -> Trajectory:
        """The motion at `rate` [Hz] from time 0, by quintic Hermite interpolation (angle C2
        everywhere).

        Args:
            hold: time [s] for which the last pose is held at the end.
        """
        count = math.floor((self.duration + hold) * rate + 1e-6) + 1
        time = np.arange(count) / rate
        inside = np.minimum(time, self.duration)
        q, qd, qdd = _quintic(self.time - self.time[0], self.q, self.qd, self.qdd, inside)
        over = time > self.duration + 1e-9
        qd[over] = 0.0
        qdd[over] = 0.0
        return Trajectory(time, q, qd, qdd)


def from_angles(time: ArrayLike, q: ArrayLike) -> Trajectory:
    """A trajectory from angles alone: cubic spline (C2) that starts and ends at rest.

    Args:
        time: [s], shape (n,).
        q: angles [rad], shape (n, axes).
    """
    from scipy.interpolate import CubicSpline

    t = np.asarray(time, dtype=float)
    angles = np.asarray(q, dtype=float)
    if (
        t.ndim != 1
        or angles.ndim != 2
        or len(t) != len(angles)
        or len(t) < 3
        or not np.isfinite(angles).all()
    ):
        raise InputError(
            f"trajectory: found time {t.shape}, q {angles.shape}; expected finite (n,), (n, axes), "
            "n >= 3"
        )
    if (np.diff(t) <= 0).any():
        raise InputError("trajectory: time does not increase")
    spline = CubicSpline(t, angles, bc_type="clamped")
    return Trajectory(t, angles, spline(t, 1), spline(t, 2))


def load_trajectory(path: Path | str, axes: int = 6) -> Trajectory:
    """Read `trajectory.csv` (`time_s, q1_deg…`, optionally `qd1_deg_s…, qdd1_deg_s2…`; rad also),
    `.csv` or `.csv.gz`.

    Raises:
        InputError: no such file, missing columns (which), or values that are not numbers (which
        row).
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(
            f"no trajectory file {path}; expected a CSV with time_s, q1_deg … q{axes}_deg"
        )
    with gzip.open(path, "rt") if path.suffix == ".gz" else path.open(newline="") as file:
        rows = [row for row in csv.reader(file) if row]
    if not rows:
        raise InputError(f"{path} is empty; expected a header and rows of numbers")
    header = [name.strip() for name in rows[0]]
    table = np.full((len(rows) - 1, len(header)), np.nan)
    for i, row in enumerate(rows[1:]):
        try:
            table[i, : len(row)] = [float(cell) for cell in row]
        except ValueError as error:
            raise InputError(
                f"{path}, line {i + 2}: {error}; expected one number per column of the header"
            ) from error
    time = _columns(path, header, table, ["time_s"])
    q = _angles(path, header, table, "q", "", axes)
    if time is None or q is None:
        raise InputError(
            f"{path} lacks time_s or q1_deg … q{axes}_deg (or _rad); its columns are "
            f"{', '.join(header)}"
        )
    qd = _angles(path, header, table, "qd", "_s", axes)
    qdd = _angles(path, header, table, "qdd", "_s2", axes)
    if qd is None or qdd is None:
        return from_angles(time[:, 0], q)
    return Trajectory(time[:, 0], q, qd, qdd)


def _angles(
    path: Path, header: list[str], table: Array, name: str, per: str, axes: int
) -> Array | None:
    for unit, factor in (("deg", math.pi / 180), ("rad", 1.0)):
        found = _columns(path, header, table, [f"{name}{j + 1}_{unit}{per}" for j in range(axes)])
        if found is not None:
            return factor * found
    return None


def _columns(path: Path, header: list[str], table: Array, names: list[str]) -> Array | None:
    present = [name in header for name in names]
    if any(present) and not all(present):
        missing = [name for name, there in zip(names, present, strict=True) if not there]
        raise InputError(f"{path} lacks the columns {', '.join(missing)}")
    return table[:, [header.index(name) for name in names]] if all(present) else None


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
