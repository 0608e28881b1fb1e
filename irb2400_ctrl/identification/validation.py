"""Modelled against measured torque: the paper's Tab. 6 (eqs. 75-77) for any robot and log."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.preparation.metrics import Errors, errors
from irb2400_ctrl.diagnosis.preparation.turned_motors import with_turning_motors
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_json
from irb2400_ctrl.identification.another_day.never_identified import never_identified
from irb2400_ctrl.identification.another_day.otherwise import otherwise
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed


@dataclass(frozen=True)
class LogComparison:
    """A robot file against one log.

    Args:
        time: [s], (m,); q, qd: [rad], [rad/s], measured, modelled: [Nm], (m, n);
        known: samples that count, (m, n).
        remarks: what the reader should know of how it was recorded, and of a file that was never
            identified.
        changed: what is not as it was when the robot was identified (`otherwise`).
        problem: why its columns cannot be what they say, where that was asked and is so.
    """

    log: str
    time: Array
    q: Array
    qd: Array
    measured: Array
    modelled: Array
    known: Mask
    remarks: tuple[str, ...] = ()
    changed: tuple[str, ...] = ()
    problem: str = ""

    @property
    def error(self) -> Errors:
        """MAE, RMSE, RMSE over mean torque per joint."""
        return errors(self.measured, self.modelled, self.known)

    @property
    def notes(self) -> tuple[str, ...]:
        """All that is to be said of it beside a problem; columns that are not what they say tell
        nothing of the arm."""
        return self.remarks if self.problem else (*self.changed, *self.remarks)


@dataclass(frozen=True)
class Validation:
    """A robot file against one or several logs."""

    robot: str
    logs: tuple[LogComparison, ...]

    @property
    def error(self) -> Errors:
        """MAE, RMSE, RMSE over mean torque per joint, over the samples of all logs."""
        parts = [
            np.concatenate([getattr(log, name) for log in self.logs])
            for name in ("measured", "modelled", "known")
        ]
        return errors(parts[0], parts[1], parts[2].astype(bool))

    def to_json(self) -> dict[str, Any]:
        """As in validation.json."""
        return {
            "schema_version": 1,
            "robot": self.robot,
            "log": ", ".join(log.log for log in self.logs),
            "samples": [int(v) for v in sum(log.known.sum(axis=0) for log in self.logs)],
            "error": self.error.to_json(),
            "logs": [
                {
                    "name": log.log,
                    "error": log.error.to_json(),
                    "remarks": [*[log.problem] * bool(log.problem), *log.notes],
                }
                for log in self.logs
            ],
        }

    def with_problems(self, problems: Sequence[str]) -> Validation:
        """With why the columns of each log cannot be what they say; empty where they can."""
        pairs = zip(self.logs, problems, strict=True)
        return replace(self, logs=tuple(replace(log, problem=problem) for log, problem in pairs))

    def write(self, folder: Path | str) -> None:
        """validation.json."""
        write_json(Path(folder) / "validation.json", self.to_json())


@typed
def validate(robot: Robot, log: Log | Sequence[Log]) -> Validation:
    """What a robot file says along one or several logs, against what was measured.

    Raises:
        InputError: no log, or another number of joints.
    """
    logs = [log] if isinstance(log, Log) else list(log)
    if not logs:
        raise InputError("validate: found no log, expected at least one")
    return Validation(robot.name, tuple(_compared(robot, one) for one in logs))


def _compared(robot: Robot, log: Log) -> LogComparison:
    if log.n != robot.n:
        raise InputError(
            f"{log.name}: found {log.n} joints, expected the {robot.n} of {robot.name}; give the "
            "robot of this log"
        )
    # with the time base rebuilt
    m = with_turning_motors(robot, prepare(log, quiet=True))
    modelled = predicted_torque(robot, m)
    of_the_file = never_identified(robot, m, modelled)
    remarks = (*of_the_file, *_seen_before(robot, log), *m.remarks)
    changed = otherwise(robot, m, modelled)
    return LogComparison(log.name, m.time, m.q, m.qd, m.tau, modelled, m.known, remarks, changed)


def _seen_before(robot: Robot, log: Log) -> tuple[str, ...]:
    """What is to be said of a log from which the robot was identified."""
    name = Path(log.name).name
    known = () if robot.identified is None else robot.identified.logs
    # a log of a script may have no name of its own
    if not Path(name).suffix or name not in {Path(one).name for one in known}:
        return ()
    return (
        f"the robot was identified from {name}: its numbers fit this log better than another "
        "motion, as the errors that `identify` printed of unseen stretches",
    )
