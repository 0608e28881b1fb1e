"""What an identification says: the robot, how surely, what moved, and what is left."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.preparation.metrics import Errors, errors
from irb2400_ctrl.files import write_atomic, write_json
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.told_extras import extra_json
from irb2400_ctrl.identification.force_sensor import SensedLoad
from irb2400_ctrl.identification.friction_curve import FrictionCurve
from irb2400_ctrl.identification.gains import Gains
from irb2400_ctrl.identification.gate import Verdict
from irb2400_ctrl.identification.late_torques import Late
from irb2400_ctrl.identification.moved import Moved
from irb2400_ctrl.notebook import Displayed
from irb2400_ctrl.robot import Robot, save_robot


@dataclass(frozen=True)
class LogResult:
    """One log against three models; arrays (m, n).

    Args:
        role: "identification" (the fit that is judged had not seen the stretch it predicts) or
            "validation" (the final fit);
        q, qd: angle and speed [rad], [rad/s]; known: samples that count.
        before: the robot as given; fitted: the robot identified from all logs; unseen: the fit
            judged; plain: plain least squares on the same stretches as `unseen`.
    """

    name: str
    role: str
    time: Array
    q: Array
    qd: Array
    measured: Array
    known: Mask
    before: Array
    fitted: Array
    unseen: Array
    plain: Array

    @property
    def modelled(self) -> Array:
        """`unseen`, which is what judges the fit."""
        return self.unseen

    def error(self, which: str) -> Errors:
        """Eqs. 75-77 of `before`, `fitted`, `unseen` or `plain`."""
        return errors(self.measured, getattr(self, which), self.known)

    def to_json(self) -> dict[str, Any]:
        """As in identification.json."""
        models = ("before", "fitted", "unseen", "plain")
        return {
            "name": self.name,
            "role": self.role,
            "error": {which: self.error(which).to_json() for which in models},
        }


@dataclass(frozen=True, repr=False)
class Identification(Displayed):
    """The result of `identify`.

    Args:
        given, robot: the file, and what was identified.
        theta, covariance: numbers of the columns of `layout`, (p,), (p, p).
        source: where speed and acceleration were taken from, "angle" or "speed".
        sigma: rms torque that is left per joint [Nm], (n,);
        correlation: samples that say the same thing, mean of the joints.
        moved: of every link, none where the file has no bodies; verdicts: what these motions tell
            of every number.
        notes: sentences for the reader.
        friction: of joints that ran at constant speed, forth and back (eqs. 70-74).
        gains: of the torque channels, where not all are taken to read alike;
        sensed: tool on a force sensor.
        of_bodies: what the logs say of the file's bodies, empty where `notes` say which moved.
        late: of the logs whose torques were recorded later than their angles.
    """

    given: Robot
    robot: Robot
    layout: ColumnLayout
    theta: Array
    covariance: Array
    source: str
    sigma: Array
    correlation: float
    moved: Sequence[Moved]
    verdicts: Sequence[Verdict]
    logs: Sequence[LogResult]
    notes: Sequence[str]
    friction: Sequence[FrictionCurve] = ()
    gains: Gains | None = None
    sensed: SensedLoad | None = None
    late: Sequence[Late] = ()
    of_bodies: Sequence[str] = ()

    @property
    def standard_errors(self) -> Array:
        """Of theta, shape (p,)."""
        return np.asarray(np.sqrt(np.diag(self.covariance)))

    def to_json(self) -> dict[str, Any]:
        """As in identification.json."""
        numbers = zip(self.layout.names(), self.theta, self.standard_errors, strict=True)
        return {
            "schema_version": 1,
            "robot": self.robot.name,
            "motion_from": self.source,
            "notes": list(self.notes),
            "of_bodies": list(self.of_bodies),
            "extras": [extra_json(extra) for extra in self.layout.extras],
            "residual_Nm": [float(v) for v in self.sigma],
            "samples_per_independent_one": self.correlation,
            "moved": [moved_json(m) for m in self.moved],
            "numbers": {
                name: {"value": float(value), "standard_error": float(error)}
                for name, value, error in numbers
            },
            "identifiability": [v.to_json() for v in self.verdicts],
            "friction_runs": [curve.to_json() for curve in self.friction],
            "force_sensor": None if self.sensed is None else self.sensed.to_json(),
            "late_torques": [one.to_json() for one in self.late],
            "gains": None if self.gains is None else self.gains.to_json(),
            "logs": [log.to_json() for log in self.logs],
        }

    def write(self, folder: Path | str) -> None:
        """identification.json, covariance.json and robot.toml; the report is another's."""
        folder = Path(folder)
        covariance = {
            "schema_version": 1,
            "names": self.layout.names(),
            "covariance": [[float(v) for v in row] for row in self.covariance],
        }
        write_json(folder / "identification.json", self.to_json())
        write_atomic(folder / "covariance.json", json.dumps(covariance) + "\n")
        save_robot(self.robot, folder / "robot.toml")


def moved_json(moved: Moved) -> dict[str, Any]:
    """One body of identification.json."""
    name, sigmas = moved.most
    return {
        "link": moved.link,
        "furthest": name,
        "sigmas": sigmas,
        "mass_kg": {"before": float(moved.before[0]), "after": float(moved.after[0])},
        "com_m": {"before": moved.before[1:4].tolist(), "after": moved.after[1:4].tolist()},
        "inertia_kgm2": {"before": moved.before[4:].tolist(), "after": moved.after[4:].tolist()},
        "not_the_files": moved.alarms,
    }
