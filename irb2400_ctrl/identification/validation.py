"""Modelled against measured torque: the paper's Tab. 6 (eqs. 75-77) for any robot and log."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.preparation.metrics import Errors, errors
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.joined_log import prepare_together
from irb2400_ctrl.robot import Robot


@dataclass(frozen=True)
class Validation:
    """A robot file against a log.

    Args:
        time: [s], (m,); measured, modelled: [Nm], (m, n); known: samples that count, (m, n).
    """

    robot: str
    log: str
    time: Array
    measured: Array
    modelled: Array
    known: Mask

    @property
    def error(self) -> Errors:
        """MAE, RMSE, RMSE over mean torque per joint."""
        return errors(self.measured, self.modelled, self.known)

    def to_json(self) -> dict[str, Any]:
        """As in validation.json."""
        return {
            "schema_version": 1,
            "robot": self.robot,
            "log": self.log,
            "samples": [int(v) for v in self.known.sum(axis=0)],
            "error": self.error.to_json(),
        }

    def write(self, folder: Path | str) -> None:
        """validation.json."""
        write_atomic(Path(folder) / "validation.json", json.dumps(self.to_json(), indent=2) + "\n")


def validate(robot: Robot, *logs: Log) -> Validation:
    """What a robot file says along one log or several, against what was measured.

    Raises:
        InputError: no log, another number of joints.
    """
    for log in logs:
        if log.n != robot.n:
            raise InputError(
                f"{log.name}: found {log.n} joints, expected the {robot.n} of {robot.name}; give "
                "the robot of this log"
            )
    motion = prepare_together(logs)
    modelled = predicted_torque(robot, motion)
    name = ", ".join(log.name for log in logs)
    return Validation(robot.name, name, motion.time, motion.tau, modelled, motion.known)
