"""`Log`: a recorded motion of an arm, SI and radians, exactly as it was sampled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError

MIN_RATE = 10.0
"""[Hz] below this the torque of a moving arm is not resolved"""


@dataclass(frozen=True)
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
            if value is not None:
                object.__setattr__(self, key, _own(value))
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
            hint = "sort the rows, delete doubled ones"
            if steps[k] == 0 and (self.q[k] != self.q[k + 1]).any():
                hint += "; of a clock too coarse for its rows, state rate_Hz in a column map"
            raise InputError(
                f"{self.name}: time does not rise at sample {k + 2} ({self.time[k]:g} s, then "
                f"{self.time[k + 1]:g} s); "
                f"expected rising times: {hint}"
            )
        if self.rate < MIN_RATE * 0.999:
            raise InputError(
                f"{self.name}: found {self.rate:.3g} samples per second, expected at least "
                f"{MIN_RATE:.0f}; "
                "is time_s in seconds? Milliseconds are time_ms"
            )

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


def _own(value: Array) -> Array:
    """The array itself where nobody can write to it, else a copy of it."""
    array = np.asarray(value, dtype=float)
    if array.flags.writeable or not array.flags.owndata:
        array = np.array(array)
        array.setflags(write=False)
    return array
