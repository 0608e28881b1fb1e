"""`diagnose_change`: what is otherwise than on a day when the arm was known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from irb2400_ctrl.diagnosis import Diagnosis, Number, diagnose
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.numbers import RATIO
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.another_day.reference_error import (
    has_changed,
    simplest,
    unseen_error,
    worse_joints,
)
from irb2400_ctrl.identification.identification import Identification
from irb2400_ctrl.identification.identify import identify
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

TERMS = {
    "coulomb": ("", "coulomb_Nm", 1),
    "viscous": ("", "viscous_Nms_rad", 2),
    "offset": ("torque_offset", "offset_Nm", 0),
    "rotor": ("rotor_inertia", "rotor_kgm2", 0),
}
"""drive terms: the effect that states one, its name, or its column of the file's friction"""
SEEN = 3.0
"""standard errors that a number must stand out"""


@typed
def diagnose_change(
    robot: Robot,
    log: Log | Sequence[Log],
    reference: Robot | Log | Sequence[Log],
    validation: Log | None = None,
    *,
    progress: Callable[[str], None] = lambda stage: None,
) -> Diagnosis:
    """What changed on an arm since its reference.

    From reference logs the base is identified first; its covariance is the prior afterwards. What
    those logs show beside the base (a ripple, a cable) was there before: it is special here, but no
    change. A reference robot counts as it is, with the covariance that its file carries.

    Args:
        robot: the file, where the identification begins.
        log: of today; reference: of the same arm on another day, or its robot file.
        validation: another motion of today, for the errors only.
        progress: told the name of each stage.

    Raises:
        InputError: a log does not fit the robot, is not understood, or is one of the reference's.
    """
    if isinstance(reference, Robot):
        return diagnose(robot, log, validation, reference, progress=progress)
    logs = [reference] if isinstance(reference, Log) else list(reference)
    for today in [log] if isinstance(log, Log) else log:
        _check_new(today, logs)
    progress("identify the reference")
    known = identify(robot, logs)
    progress("diagnose the reference")
    before = diagnose(known.robot, logs)
    progress("diagnose")
    found = diagnose(robot, log, validation, before.robot, progress=progress)
    unseen = unseen_error(known, found.least_floor)
    progress("leave out what the reference leaves too")

    def few(most: int) -> Diagnosis:
        return diagnose(robot, log, validation, before.robot, criteria=Criteria(most=most))

    found = simplest(found, few, before, unseen)
    error = found.identification.error_before.rmse
    worse = worse_joints(error, found.least_floor, before, unseen)
    stiffer = {number.place for number in found.numbers if number.name == RATIO}
    there = (*lacking(robot, known), *before.numbers)
    return replace(
        found,
        numbers=tuple(n for n in found.numbers if has_changed(n, worse, stiffer)),
        usual_error=unseen,
        before=replace(before, numbers=there),
    )


def _check_new(today: Log, reference: Sequence[Log]) -> None:
    """A log that the reference was learned from shows no change, whatever has happened."""
    copied = today.copied_from(reference)
    if copied is not None:
        raise InputError(
            f"{today.name}: found the samples of the reference {copied}, expected a log of another "
            "day: nothing can have changed in it"
        )


def lacking(robot: Robot, known: Identification) -> tuple[Number, ...]:
    """Drive numbers that the file does not state, as the reference shows them."""
    stated = {(effect.kind, effect.joint) for effect in robot.effects}
    found = []
    for term, (kind, name, column) in TERMS.items():
        place = known.layout.drive(term)
        values = known.theta[place]
        errors = known.standard_errors[place]
        for j in range(robot.n):
            there = (kind, j + 1) in stated if kind else bool(robot.friction[j, column] > 0)
            if there or abs(values[j]) < SEEN * errors[j]:
                continue
            sigmas = float(values[j] / errors[j])
            value = float(values[j])
            error = float(errors[j])
            found.append(Number("lacks", f"joint {j + 1}", name, None, value, error, sigmas))
    return tuple(found)
