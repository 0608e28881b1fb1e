"""A log made ready for comparison: uniform, smooth, differentiated, with masks of what cannot be
judged."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.instants.time_base import with_time_base
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.motion.angle_smoothing import AngleSmoothing, angle_smoothing
from irb2400_ctrl.measurement.motion.commanded import BLEND, used_angles
from irb2400_ctrl.measurement.motion.held_samples import released
from irb2400_ctrl.measurement.motion.lost_rows import with_rows_counted
from irb2400_ctrl.measurement.motion.recorded_speed import calmer_speed
from irb2400_ctrl.measurement.motion.standstill import sticking, undetermined
from irb2400_ctrl.measurement.torque_filter import TorqueFilter, find_torque_filter
from irb2400_ctrl.measurement.uniform import (
    SMOOTHING,
    LowPass,
    UniformLog,
    derivative_margin,
    derivatives,
    polished,
    resample,
    smoothed,
    widened,
)
from irb2400_ctrl.typed import typed
from irb2400_ctrl.wording import numbered

UNEVEN = (
    "the angles jump in time as where a host reads some samples twice and misses others: "
    "accelerations come from the recorded speed, which is calmer"
)
NO_COMMAND = "no commanded motion (q_ref): speeds and accelerations carry the angles' noise"
OTHER_MOTION = (
    "not as commanded (q_ref): {joints}; speeds and accelerations carry the angles' noise"
)
CUTOFF = 10.0
"""[Hz] of the common zero-phase filter"""


@dataclass(frozen=True)
class PreparedLog:
    """Motion and torque of one log on a uniform grid of m samples; arrays (m, n), SI and
    radians.

    `known` is False where a gap or a standstill leaves the torque of that joint undetermined.
    Torques of a model are compared as the log would show them (`as_recorded`, `filtered`).
    Filtered quantities have `rows` instants, `row_known` (rows, n) says which are complete.
    """

    name: str
    time: Array
    q: Array
    qd: Array
    qdd: Array
    qddd: Array
    qdddd: Array
    tau: Array
    tau_smooth: Array
    """through the smoothing that the angles went through: what predictions are compared with"""
    known: Mask
    step: float
    instrumented: bool
    """whether the motion comes from the commanded one through the servo response"""
    follow_error: Array
    """rms of measured minus used angles, shape (n,) [rad]"""
    low_pass: LowPass
    row_time: Array
    row_known: Mask
    starts: tuple[int, ...] = (0,)
    """first sample of each log, where several stand one after another (`joined_log`)"""
    names: tuple[str, ...] = ()
    """of each of several logs"""
    recorders: tuple[TorqueFilter | None, ...] = (None,)
    """what each log's torques went through before they were written"""
    held: tuple[str, ...] = ()
    """of channels that hold their last value between samples (`held_samples`) and rows that the
    clock passes over (`lost_rows`), by log"""
    by_speed: bool = False
    """whether the speed that it recorded stands in for differentiated angles (`recorded_speed`), in
    one of several logs at least"""
    disobeying: tuple[int, ...] = ()
    """joints (from 1) that do not move as commanded, where the log says how, behind a servo"""

    @property
    def parts(self) -> list[slice]:
        """Samples of each log."""
        ends = (*self.starts[1:], len(self.time))
        return [slice(*both) for both in zip(self.starts, ends, strict=True)]

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.q.shape[1])

    @property
    def rows(self) -> int:
        """Number of filtered instants."""
        return len(self.row_time)

    @property
    def from_measured(self) -> tuple[str, ...]:
        """Why speeds and accelerations carry the noise of measured angles, where they do."""
        if self.instrumented:
            return ()
        if not self.disobeying:
            return (NO_COMMAND,)
        return (OTHER_MOTION.format(joints=numbered("joint", self.disobeying)),)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the reader should know of how it was recorded."""
        said = tuple(dict.fromkeys(found.says() for found in self.recorders if found))
        return self.held + said + ((UNEVEN,) if self.by_speed else ())

    @property
    def duration(self) -> float:
        """Length of the record [s]."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def scalars(self) -> list[Array]:
        """The 5 n + 1 scalars effects may depend on, each (m,): q, qd, qdd, qddd, qdddd, time."""
        parts = (self.q, self.qd, self.qdd, self.qddd, self.qdddd)
        signals = [np.ascontiguousarray(part[:, j]) for part in parts for j in range(self.n)]
        return [*signals, self.time]

    def as_recorded(self, signal: Array) -> Array:
        """A torque of the joints, or a column of one, as the log shows it, shape (m, ...)."""
        if not any(self.recorders):
            return signal
        return np.concatenate(
            [
                signal[part] if recorder is None else recorder(signal[part], self.step)
                for part, recorder in zip(self.parts, self.recorders, strict=True)
            ]
        )

    def filtered(self, signal: Array) -> Array:
        """A torque of the joints, or a column of one, as the log shows it, through the common
        filter along the first axis, decimated: (m, ...) -> (rows, ...)."""
        return self.low_pass(signal, self.recorders)

    def recorded_rows(self, signal: Array) -> Array:
        """A torque of the joints, or a column of one, as the log shows it, at the instants of the
        rows, not filtered."""
        return self.low_pass.instants(self.as_recorded(signal))

    def filtered_reading(self, signal: Array) -> Array:
        """The same of what was read, or of what a prediction as recorded leaves of it."""
        return self.low_pass(signal)

    def at_rows(self, signal: Array) -> Array:
        """A signal at the instants of the rows, not filtered."""
        return self.low_pass.instants(signal)

    def without(self, unknown: Mask) -> PreparedLog:
        """The same log without some torques, nor the rows that these reach.

        Args:
            unknown: samples whose torque is undetermined, (m, n).
        """
        reached = widened(unknown, self.low_pass.half)
        return replace(
            self,
            known=self.known & ~unknown,
            row_known=self.row_known & ~self.low_pass.instants(reached),
        )


@typed
def prepare(log: Log, rate: float | None = None, *, quiet: bool = False) -> PreparedLog:
    """Rebuild the time base of a log, resample, smooth and differentiate it.

    The motion is the commanded one through the fitted servo response where that explains the
    measured angles down to their noise; a joint that also moves otherwise (the true motion under
    disturbances) keeps its measured, smoothed angles.

    Args:
        rate: of the grid [Hz]; default the log's own, but 200 to 250 Hz.
        quiet: smooth measured angles as strongly as their noise asks (`angle_smoothing`), where
            torques are compared as they stand; default alike, and torques go through the same.
    """
    even, held = _evenly(log)
    uniform = resample(even, rate)
    q, instrumented, disobeying = used_angles(uniform, even)
    parts, by_speed, reach = _derived(q, instrumented, even, uniform, quiet)
    margin = derivative_margin(uniform.step)
    inside = slice(margin, len(q) - margin)
    positions, qd, qdd, qddd, qdddd = (part[inside] for part in parts)
    recorder = find_torque_filter(uniform.tau[inside], positions, qd, qdd, uniform.step, even.rate)
    low_pass = LowPass(CUTOFF, uniform.step, np.inf if recorder is None else recorder.highest)
    if len(positions) < 4 * low_pass.half:
        raise InputError(f"{log.name}: found {log.duration:.2f} s of data, expected at least 2 s")
    gap = _incomplete(uniform, margin + reach, quiet and instrumented)[inside]
    still = undetermined(uniform.tau[inside], qd, uniform.step, instrumented)
    determined = ~(still | gap[:, None])
    if not instrumented:
        still = sticking(still, qd, uniform.step)
    known = ~(still | gap[:, None])
    if recorder is not None:
        determined = _smeared(determined, recorder.reach(uniform.step))
        known &= determined
    beside = low_pass.half + (0 if instrumented else margin)
    row_known = low_pass.instants(~widened(~determined, beside))
    return PreparedLog(
        name=log.name,
        time=uniform.time[inside],
        q=positions,
        qd=qd,
        qdd=qdd,
        qddd=qddd,
        qdddd=qdddd,
        tau=uniform.tau[inside],
        tau_smooth=(uniform.tau if instrumented else smoothed(uniform.tau, uniform.step))[inside],
        known=known,
        step=uniform.step,
        instrumented=instrumented,
        follow_error=rms((uniform.q - q)[inside][~gap]),
        low_pass=low_pass,
        row_time=low_pass.instants(uniform.time[inside]),
        row_known=row_known,
        recorders=(recorder,),
        held=held,
        by_speed=by_speed,
        disobeying=disobeying,
    )


def _evenly(log: Log) -> tuple[Log, tuple[str, ...]]:
    """A log with its time base rebuilt, and what was done to its rows."""
    # what is held, or repeated under a time of its own, is no row that the clock passes over
    fresh, held = released(log)
    counted, rows = with_rows_counted(fresh)
    return with_time_base(counted if rows else log), tuple(filter(None, (rows, held)))


def _derived(
    q: Array, instrumented: bool, recorded: Log, uniform: UniformLog, quiet: bool
) -> tuple[tuple[Array, ...], bool, int]:
    """q, qd, qdd, qddd, qdddd of a motion, whether all but q come from the recorded speed, and
    samples that a stronger smoothing makes incomplete beside the usual ones.
    """
    step = uniform.step
    if instrumented:
        # a commanded motion has only its last digit to be smoothed away: no torque needs to share
        # that
        return derivatives(polished(q, step), step), False, 0
    alike = AngleSmoothing(np.full(q.shape[1], SMOOTHING), step)
    smoothing = angle_smoothing(uniform, q, recorded) if quiet else alike
    parts = derivatives(smoothing(q), step)
    away = ~widened(~uniform.valid, derivative_margin(step))
    by_speed = calmer_speed(recorded, step, parts[1], parts[2], away)
    found = parts if by_speed is None else (parts[0], *by_speed)
    return found, by_speed is not None, smoothing.reach


def _incomplete(log: UniformLog, reach: int, blended: bool) -> Mask:
    """Samples within reach of a gap, or of an end.

    Args:
        log: on the grid; reach: samples.
        blended: whether the start, blended in from measured angles, counts as a gap: it has their
            noise.
    """
    known = log.valid.copy()
    known[: round(BLEND / log.step) if blended else 0] = False
    beyond = np.zeros(1, dtype=bool)
    return widened(~np.concatenate([beyond, known, beyond]), reach)[1:-1]


def _smeared(determined: Mask, reach: int) -> Mask:
    """What is determined where a value holds what stands up to `reach` samples away, and what came
    before and after the log."""
    found = ~widened(~determined, reach)
    found[:reach] = False
    found[len(found) - reach :] = False
    return found
