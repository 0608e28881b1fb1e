"""Errors before and after on each of several logs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.metrics import Errors, errors
from irb2400_ctrl.diagnosis.preparation.turned_motors import with_turning_motors
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.diagnosis.sound_logs import SoundLogs
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.joined_log import prepare_together
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot


@dataclass(frozen=True)
class LogErrors:
    """One log against the robot as given and with what was found.

    Args:
        used: effects were looked for on it; else it is only judged.
        start: of the log on the common clock [s], to which windows of effects refer; None if it
            was not used.
    """

    name: str
    used: bool
    start: float | None
    before: Errors
    after: Errors

    def to_json(self) -> dict[str, Any]:
        """As in findings.json."""
        return {
            "log": self.name,
            "used": self.used,
            "starts_s": self.start,
            "error": {"before": self.before.to_json(), "after": self.after.to_json()},
        }


def errors_of_each(motion: PreparedLog, before: Array, after: Array) -> list[LogErrors]:
    """Of the logs that stand one after another in a motion; predictions (m, n) [Nm].

    Args:
        motion: of several logs one after another.
        before: torque that the robot as given predicts [Nm], shape (m, n).
        after: torque with what was found [Nm], shape (m, n).
    """
    names = motion.names or (motion.name,)
    found = []
    for name, part in zip(names, motion.parts, strict=True):
        tau = motion.tau[part]
        known = motion.known[part]
        start = float(motion.time[part.start])
        pair = (errors(tau, torque[part], known) for torque in (before, after))
        found.append(LogErrors(name, True, start, *pair))
    return found


def judged(log: Log, before: Robot, after: Robot) -> LogErrors | None:
    """A log that was not used; None where it cannot be prepared.

    Args:
        log: as recorded.
        before: the robot as given.
        after: the robot with what was found.
    """
    try:
        motion = with_turning_motors(before, prepare_together([log]))
    except InputError:
        return None
    pair = (
        errors(motion.tau, predicted_torque(robot, motion), motion.known)
        for robot in (before, after)
    )
    return LogErrors(log.name, False, None, *pair)


def log_errors(
    motion: PreparedLog, before: Array, after: Array, logs: SoundLogs, robots: tuple[Robot, Robot]
) -> tuple[LogErrors, ...]:
    """Every sound log; `robots`: as given, and with what was found."""
    found = errors_of_each(motion, before, after)
    rest = [judged(log, *robots) for log in logs.judged]
    return (*found, *(one for one in rest if one is not None))
