"""What a log holds: rate, length, channels, digits, jitter, loss, gaps, lag behind the command."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.measurement.instants.grouped_stamps import grouped
from irb2400_ctrl.measurement.instants.time_base import TimeBase, time_base
from irb2400_ctrl.measurement.log import Log

GAP = 2.5
"""periods from which a pause between samples is a gap"""
FOURTH = np.sqrt(70.0)
"""a fourth difference of white noise over the noise"""
NORMAL = 0.6745
"""median of the size of a normal variable over its standard deviation"""
LAG = 0.25
"""[s] longest lag that is looked for"""
WHOLE = 0.1
"""of a digit, within which a step is a whole number of digits"""
REACHES = (8.0, 64.0, 512.0)
"""digits up to which steps are counted, each with the mean of those before"""
MOSTLY = 0.9
"""share of the steps that are, of a digit (random ones: twice `WHOLE`)"""


@dataclass(frozen=True)
class LogFacts:
    """Measured on the log alone; arrays per joint, shape (n,).

    Args:
        rate: of the even sampling [Hz]; duration: [s]; samples: count.
        base: what is known of the instants.
        gaps: pauses longer than 2.5 periods; longest_gap: [s].
        angle_digit, torque_digit: digit of a column [rad], [Nm]; zero where it never moves.
        angle_noise, torque_noise: rms of what neighbours disagree about [rad], [Nm].
        lag: of the angle behind the commanded one [s], NaN where a joint rests; None without it.
        travel: range of each joint [rad]; torque: rms torque of each joint [Nm].
    """

    rate: float
    duration: float
    samples: int
    joints: int
    channels: tuple[str, ...]
    base: TimeBase
    gaps: int
    longest_gap: float
    angle_digit: Array
    torque_digit: Array
    angle_noise: Array
    torque_noise: Array
    lag: Array | None
    travel: Array
    torque: Array

    def to_json(self) -> dict[str, Any]:
        """Plain numbers, the unit in each name."""
        return {
            "rate_Hz": _short(self.rate),
            "duration_s": _short(self.duration),
            "samples": self.samples,
            "joints": self.joints,
            "channels": list(self.channels),
            "jitter_ms": _short(1e3 * self.base.scatter),
            "lost_percent": _short(100.0 * self.base.lost),
            "time_base_rebuilt": self.base.rebuilt,
            "gaps": self.gaps,
            "longest_gap_s": _short(self.longest_gap),
            "angle_digit_deg": _list(np.degrees(self.angle_digit)),
            "torque_digit_Nm": _list(self.torque_digit),
            "angle_noise_deg": _list(np.degrees(self.angle_noise)),
            "torque_noise_Nm": _list(self.torque_noise),
            "lag_ms": None if self.lag is None else _list(1e3 * self.lag),
            "travel_deg": _list(np.degrees(self.travel)),
            "torque_rms_Nm": _list(self.torque),
        }


def log_facts(log: Log) -> LogFacts:
    """Measure a log."""
    base = time_base(log)
    # the stamps of samples that came in groups say nothing of the rate
    in_groups = base.rebuilt and grouped(log.time)
    steps = np.diff(base.time if in_groups else log.time)
    wide = steps > GAP * np.median(steps)
    names = ["time", "q", "tau"]
    names += [name for name in ("qd", "q_ref") if getattr(log, name) is not None]
    return LogFacts(
        rate=1.0 / float(np.median(steps)),
        duration=log.duration,
        samples=len(log.time),
        joints=log.n,
        channels=(*names, *log.extra),
        base=base,
        gaps=int(wide.sum()),
        longest_gap=float(steps.max()),
        angle_digit=digit(log.q),
        torque_digit=digit(log.tau),
        angle_noise=neighbour_noise(log.q),
        torque_noise=neighbour_noise(log.tau),
        lag=None if log.q_ref is None else command_lag(log),
        travel=np.ptp(log.q, axis=0),
        torque=rms(log.tau),
    )


def digit(signal: Array) -> Array:
    """The step of which the values of a column are whole multiples apart, shape (n,).

    The smallest step between values that are next to each other in size is no digit where a joint
    only moves: then it is how far it moved from row to row, and Euclid's algorithm goes on from
    there. A column without digits has one of rounding.
    """
    return np.array([_digit(column) for column in signal.T])


def _digit(column: Array) -> float:
    """As of `digit`, of one column, shape (m,)."""
    steps = np.diff(np.unique(column))
    # values that rounding makes differ in the last bits are one value
    rounding = float(1e-10 * np.abs(column).max(initial=0.0))
    steps = steps[steps > rounding]
    if not len(steps):
        return 0.0
    while len(steps):
        found = float(steps.min())
        # digits of a sensor are printed in those of a file: what is nearly whole is whole, and what
        # the print takes from a digit counts as often as that goes into a step
        mean = _mean_digit(steps, found)
        if np.sum(_rest(steps, mean) > WHOLE * mean) < (1.0 - MOSTLY) * len(steps):
            return mean
        # of the rest, not of the steps: an error of the digit counts as often as it goes into one
        rest = _rest(steps, found)
        steps = rest[rest > max(WHOLE * found, rounding)]
    return rounding


def _mean_digit(steps: Array, least: float) -> float:
    """Digit of all steps from the least of them: of a few digits first, whose number is sure."""
    for reach in REACHES:
        near = steps[steps < reach * least]
        least = float(near.sum() / np.round(near / least).sum())
    return least


def _rest(steps: Array, digit: float) -> Array:
    """What lacks of a whole number of digits, or is beyond it."""
    return np.asarray(np.abs(steps - digit * np.round(steps / digit)))


def neighbour_noise(signal: Array) -> Array:
    """Standard deviation of white noise from fourth differences (median), shape (n,)."""
    if len(signal) < 10:
        return np.zeros(signal.shape[1])
    fourth = np.abs(np.diff(signal, 4, axis=0))
    return np.asarray(np.median(fourth, axis=0) / NORMAL / FOURTH)


def command_lag(log: Log) -> Array:
    """Lag of the angle behind the commanded one that makes them agree best, shape (n,) [s]."""
    assert log.q_ref is not None
    found = np.full(log.n, np.nan)
    for j in range(log.n):
        rate = np.gradient(log.q_ref[:, j], log.time)
        power = float(rate @ rate)
        if np.ptp(log.q_ref[:, j]) < 0.02:
            continue
        first = float((log.q_ref[:, j] - log.q[:, j]) @ rate) / power
        # one step of Gauss-Newton from there: the command itself, shifted
        for _ in range(4):
            shifted = np.interp(log.time - np.clip(first, -LAG, LAG), log.time, log.q_ref[:, j])
            first += float((shifted - log.q[:, j]) @ rate) / power
        found[j] = first if abs(first) < LAG else np.nan
    return found


def _short(value: float) -> float:
    return float(f"{value:.5g}")


def _list(values: Array) -> list[float | None]:
    return [_short(float(v)) if np.isfinite(v) else None for v in values]
