"""One arm from log to finding to controller and back: how it follows a motion before and after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from independent_plant import Case, Driven
from independent_plant import Log as PlantLog

from irb2400_ctrl.codegen.host_library import Real
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot

from .generated import generated_drive

CONTROLLERS = ("feedforward_pid", "computed_torque")


@dataclass(frozen=True)
class Tracking:
    """How a controller made from one description of the arm followed a motion; rms values.

    Args:
        joints: error of the true angles [rad], (6,); tip: distance of the tool's tip from its place
            [m].
    """

    joints: np.ndarray
    tip: float

    @classmethod
    def of(cls, run: Driven) -> Tracking:
        """The rms errors of one run."""
        return cls(
            np.sqrt(((run.q - run.q_ref) ** 2).mean(axis=0)),
            float(np.sqrt((run.tip_error**2).mean())),
        )


@dataclass(frozen=True)
class Closed:
    """An arm, what was said about it, and by controller name what a description was worth.

    Args:
        given: controllers from the robot as it was believed to be.
        recalibrated: from the same with the parameters of the diagnosis, but without what it found.
        diagnosed: from the robot with what it found.
    """

    case: Case
    diagnosis: Diagnosis
    given: dict[str, Tracking]
    recalibrated: dict[str, Tracking]
    diagnosed: dict[str, Tracking]


def measured(log: PlantLog, name: str) -> Log:
    """A log of the plant as the library takes it."""
    return Log(log.time, log.q, log.tau, qd=log.qd, q_ref=log.q_ref, name=name)


def close(
    case: Case, robot: Robot, controllers: tuple[str, ...] = CONTROLLERS, *, real: Real = "float"
) -> Closed:
    """Diagnose the arm's identification log; follow its validation motion with controllers from
    each description."""
    diagnosis = diagnose(robot, measured(case.simulate()[0], "identification"))
    plain = diagnosis.robot.model_copy(update={"effects": robot.effects})
    given, recalibrated, diagnosed = (
        {name: Tracking.of(followed(case, name, known, real)) for name in controllers}
        for known in (robot, plain, diagnosis.robot)
    )
    return Closed(case, diagnosis, given, recalibrated, diagnosed)


def followed(case: Case, name: str, known: Robot, real: Real = "float") -> Driven:
    """The arm's validation motion under the generated C of a controller that knows `known`."""
    return case.drive(generated_drive(controller(name, known), case.motions[1].q, real))
