"""`Log`: a recorded motion of an arm, SI and radians, exactly as it was sampled."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers

MIN_RATE = 10.0
"""[Hz] below this the torque of a moving arm is not resolved"""
FASTEST = 8e3
"""[Hz] at which recorders of arms sample at most"""
NEAR = 0.05
"""of the whole span, from its beginning, to where the clock of another record goes back"""
LEAST_ROWS = 20
"""of a record"""
MOSTLY = 0.9
"""share of the steps back that stay within a second where digits are lost"""
_WRAPPED = "a counter of {} bits that wraps"
SET_BACK = {
    3600.0: "the clock was set back by an hour, as at the end of summer time",
    86400.0: "the clock passes midnight",
    2**16 * 1e-3: _WRAPPED.format(16),
    2**32 * 1e-3: _WRAPPED.format(32),
    2**32 * 1e-6: _WRAPPED.format(32),
    2**32 * 1e-9: _WRAPPED.format(32),
}
"""seconds by which a clock goes back once, and what it is then"""


def _set_back(by: float, step: float) -> str:
    """What a clock is that goes back once by so many seconds, a step of its rows less, and on from
    there; nothing where that is not told."""
    for seconds, what in SET_BACK.items():
        if abs(by + step - seconds) < 2.0 * step:
            return f"{what}: add {seconds:.10g} s to the times from there on"
    return ""


@dataclass(frozen=True, repr=False)
class Log:
    """A recorded motion; arrays are read-only.

    Args:
        time: instants of the samples [s], strictly rising, shape (m,); gaps and jitter are allowed.
        q: measured actuator angles [rad], shape (m, n).
        tau: measured actuator torques [Nm], shape (m, n).
        qd: measured actuator speeds [rad/s], shape (m, n), if recorded.
        q_ref: commanded actuator angles [rad], shape (m, n), if recorded.
        extra: columns that are none of these, as read, by header name.
        name: what to call the log in messages and reports.

    Raises:
        InputError: shapes differ, a number is not finite, time does not rise, fewer than 10 samples
        per second.
    """

    time: Array
    q: Array
    tau: Array
    qd: Array | None = None
    q_ref: Array | None = None
    extra: Mapping[str, Array] = field(default_factory=dict)
    name: str = "log"

    def __post_init__(self) -> None:
        for key in ("time", "q", "tau", "qd", "q_ref"):
            value = getattr(self, key)
            if value is not None or key in ("time", "q", "tau"):
                object.__setattr__(self, key, _own(f"{self.name}, {key}", value))
        object.__setattr__(self, "extra", MappingProxyType(dict(self.extra)))
        self._check()

    def _check(self) -> None:
        if self.q.ndim != 2 or self.time.shape != (len(self.q),):
            raise InputError(
                f"{self.name}: found angles {self.q.shape} for times {self.time.shape}, expected "
                "(m, n), (m,)"
            )
        for key in ("tau", "qd", "q_ref"):
            value = getattr(self, key)
            if value is not None and value.shape != self.q.shape:
                raise InputError(
                    f"{self.name}: found {key} of shape {value.shape}, expected {self.q.shape} as "
                    "the angles"
                )
        for key in ("time", "q", "tau", "qd", "q_ref"):
            value = getattr(self, key)
            if value is not None and not np.isfinite(value).all():
                where = np.argwhere(~np.isfinite(value))[0]
                column = f" {where[1] + 1}" if len(where) > 1 else ""
                count = int((~np.isfinite(value)).sum())
                raise InputError(
                    f"{self.name}: {key}{column} is not a number at sample {where[0] + 1} ({count} "
                    "such values); "
                    "expected finite numbers: delete the row of a lost sample"
                )
        if len(self.time) < 2:
            raise InputError(
                f"{self.name}: found {len(self.time)} samples, expected a recorded motion"
            )
        steps = np.diff(self.time)
        if (steps <= 0).any():
            k = int(np.argmax(steps <= 0))
            raise InputError(
                f"{self.name}: time does not rise at sample {k + 2} ({self.time[k]:.12g} s, then "
                f"{self.time[k + 1]:.12g} s); expected rising times: {self._why_not_rising(steps)}"
            )
        if self.rate < MIN_RATE * 0.999:
            raise InputError(
                f"{self.name}: found {self.rate:.3g} samples per second, expected at least "
                f"{MIN_RATE:.0f}; is time_s in seconds? {_unit_of(self.rate)}"
            )

    def _why_not_rising(self, steps: Array) -> str:
        """What to do about times that do not rise, by where they go back."""
        back = np.flatnonzero(steps <= 0)
        k = int(back[0])
        whole = np.floor(self.time)
        if len(back) == 1 and (told := _set_back(-steps[k], float(np.median(steps)))):
            return told
        if self._begins_again(back) and (steps[back] < 0).all():
            lengths = np.diff(back)
            if len(back) > 2 and np.ptp(lengths) <= 1:
                every = float(np.median(steps) - np.median(steps[back]))
                return (
                    f"the clock begins again every {every:.3g} s: a counter that wraps (state "
                    "rate_Hz in a column map), or records one after another (give each a file of "
                    "its own)"
                )
            return "another record begins there: give each a file of its own"
        if len(back) > 1 and (steps[back] < 0).all():
            within = whole[back] == whole[back + 1]
            if within.mean() > MOSTLY:
                return (
                    "were nanoseconds written behind the point without their leading zeros (7.8 "
                    "for 7 s and 8 ns)? Write both as columns of their own, sec and nanosec, or "
                    "sort the rows"
                )
        hint = "sort the rows, delete doubled ones"
        if steps[k] == 0 and (self.q[k] != self.q[k + 1]).any():
            hint += "; of a clock too coarse for its rows, state rate_Hz in a column map"
        return hint

    def _begins_again(self, back: npt.NDArray[np.intp]) -> bool:
        """Whether the clock goes back to where it began, and on from there, at each of these."""
        span = float(self.time.max() - self.time.min())
        near = self.time[back + 1] - self.time[0] < NEAR * span
        lengths = np.diff([-1, *back, len(self.time) - 1])
        return bool(near.all() and lengths.min() > LEAST_ROWS)

    def __repr__(self) -> str:
        rows, joints = self.q.shape
        return f"<Log {self.name}: {rows} samples of {joints} joints, {self.duration:.3f} s>"

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.q.shape[1])

    @property
    def rate(self) -> float:
        """Nominal sampling rate [Hz]: the inverse of the median step."""
        return float(1.0 / np.median(np.diff(self.time)))

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0])

    def copied_from(self, others: Iterable[Log]) -> str | None:
        """Name of the first of them whose angles and torques are the same, sample for sample."""
        for other in others:
            if np.array_equal(self.q, other.q) and np.array_equal(self.tau, other.tau):
                return other.name
        return None


def _unit_of(rate: float) -> str:
    """The unit of time by which so many samples a second are those of a recorder."""
    for per_second, name in ((1e3, "milliseconds, time_ms"), (1e6, "microseconds, time_us")):
        if MIN_RATE <= rate * per_second <= FASTEST and rate < 1.0:
            return f"In {name}, it would be {rate * per_second:.4g}"
    if MIN_RATE <= rate * 1e9 <= FASTEST:
        return f"In nanoseconds, time_ns, it would be {rate * 1e9:.4g}"
    return "Milliseconds are time_ms"


def _own(name: str, value: Array) -> Array:
    """The array itself where nobody can write to it, else a copy of it."""
    array = numbers(name, value)
    if array.flags.writeable or not array.flags.owndata:
        array = np.array(array)
        array.setflags(write=False)
    return array
