"""`diagnose`: from a robot and a log to what the robot has and its model lacks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from irb2400_ctrl.arrays import Mask, one_thread, rms
from irb2400_ctrl.diagnosis.at_rest import WORSE_AT_REST
from irb2400_ctrl.diagnosis.bent_numbers import BENT, beside_noise
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.comparison.step import Step, of_the_whole_arm
from irb2400_ctrl.diagnosis.diagnosis import Comparison, Diagnosis
from irb2400_ctrl.diagnosis.doubts import seldom_met, suspected
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.reversals import noisy_reversals_masked, reversal_rows
from irb2400_ctrl.diagnosis.estimation.unsure import unsure_of
from irb2400_ctrl.diagnosis.findings import findings_of, unexplained_of
from irb2400_ctrl.diagnosis.friction_test import moved_as_all_friction
from irb2400_ctrl.diagnosis.load_test import moved_as_by_a_load
from irb2400_ctrl.diagnosis.log_errors import log_errors
from irb2400_ctrl.diagnosis.numbers import Number, friction_is_another, friction_level, numbers
from irb2400_ctrl.diagnosis.possible_bodies import (
    IMPOSSIBLE,
    turns_impossible,
    with_possible_bodies,
)
from irb2400_ctrl.diagnosis.preparation.base_prior import BODY, BasePrior
from irb2400_ctrl.diagnosis.preparation.contacts import contacts_of
from irb2400_ctrl.diagnosis.preparation.doubtful_accelerations import doubtful_accelerations
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior, IdentifiedPrior
from irb2400_ctrl.diagnosis.preparation.metrics import errors, noise_floor
from irb2400_ctrl.diagnosis.preparation.noise_test import noise_test
from irb2400_ctrl.diagnosis.preparation.open_shapes import OpenShapes
from irb2400_ctrl.diagnosis.preparation.plain_numbers import PlainNumbers
from irb2400_ctrl.diagnosis.preparation.resting import Resting
from irb2400_ctrl.diagnosis.preparation.room import check_room
from irb2400_ctrl.diagnosis.preparation.sticking_contacts import sticking_contacts
from irb2400_ctrl.diagnosis.preparation.turned_motors import with_turning_motors
from irb2400_ctrl.diagnosis.recalibrated import recalibrated_terms
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.diagnosis.sound_logs import SoundLogs, check_beside, sound_logs
from irb2400_ctrl.diagnosis.unstated_friction import with_friction_first
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.joined_log import prepare_together
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.model.plausibility import unknown_bodies
from irb2400_ctrl.plausibility import LogProblem
from irb2400_ctrl.robot import Robot, Uncertainty
from irb2400_ctrl.typed import typed
from irb2400_ctrl.wording import numbered

COMMON_FRICTION = 0.3
"""standard deviation of the friction of all joints together, over the file's: temperature"""
WORTH = 0.01
"""share of a joint's error that a changed friction takes off at least"""
LEAST_SPEED = 0.05
"""[rad/s] rms speed of a joint below which nothing can be said about it"""


@typed
def diagnose(
    robot: Robot,
    log: Log | Sequence[Log],
    validation: Log | None = None,
    reference: Robot | None = None,
    *,
    uncertainty: Uncertainty | None = None,
    criteria: Criteria | None = None,
    progress: Callable[[str], None] = lambda stage: None,
) -> Diagnosis:
    """What the robot has and its model lacks.

    Args:
        robot: the model as it is believed to be.
        log: of the motion to explain; a wide, lively motion of all joints tells most. Several logs
            of one arm are explained together; one that is not sound is then named and left out.
        validation: another motion of the same arm; only the errors before and after are computed on
            it.
        reference: this very arm as it was on another day, taken in place of `robot`: what is found
            then has changed. Identified from logs of that day (`identification.diagnose_change`)
            its numbers count with their own covariance.
        uncertainty: of the robot's numbers; default data-sheet values.
        criteria: when an explanation counts.
        progress: told the name of each stage.

    Raises:
        InputError: the log does not fit the robot, is too short, or is broken; the validation is
            not understood, or the log itself; no link of the robot has a mass.
    """
    change = reference is not None
    robot = robot if reference is None else reference
    if why := unknown_bodies(robot):
        raise InputError(
            f"{robot.name}: {why}, expected a model that may lack something; make bodies of logs "
            "of the sound arm with `irb2400 identify`, or state them"
        )
    # the matrices are small: threads would only wait for each other
    with one_thread():
        progress("understand")
        logs = sound_logs(robot, [log] if isinstance(log, Log) else list(log))
        if logs.problem is not None:
            return _not_understood(robot, logs, logs.problem)
        if validation is not None:
            check_beside(robot, validation, logs.used)
        return _searched(robot, logs, validation, uncertainty, criteria, progress, change)


def _searched(
    robot: Robot,
    logs: SoundLogs,
    validation: Log | None,
    uncertainty: Uncertainty | None,
    criteria: Criteria | None,
    progress: Callable[[str], None],
    change: bool,
) -> Diagnosis:
    """The diagnosis of logs that are understood."""
    progress("prepare")
    given = robot
    if len(logs.other_friction) == robot.n:
        # a placeholder would bend the bodies; that of a few joints has changed, and has a name
        robot = robot.with_unknown_friction(logs.other_friction)
    motion = with_turning_motors(robot, prepare_together(logs.used))
    check_room(motion)
    bases = _bases(robot.bare())
    prior = prior_of(robot, uncertainty or robot.uncertainty, motion)
    if isinstance(prior, IdentifiedPrior):
        prior = prior.beside(OpenShapes.of(bases, robot, motion))
    numbers_of_robot = prior.columns(bases.model, motion)
    doubtful = doubtful_accelerations(bases.model, logs.used, motion)
    load = bases.model.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
    contacts = contacts_of(bases, motion, load)
    predicted = predicted_torque(robot, motion, bases)
    resting = Resting.of(motion, robot, predicted, numbers_of_robot)
    turning = sticking_contacts(bases, motion, prior.dry_friction(), contacts)
    beside = [numbers_of_robot, doubtful, resting.columns]
    Z = motion.filtered(np.concatenate([*beside, turning], 2))
    progress("scan")
    reversal = reversal_rows(motion)
    own = numbers_of_robot.shape[2]
    base = Z[:, :, : -turning.shape[2]]
    first = Fitter(robot, bases, motion, base, reversal, own, holds=resting.holds).fit([])
    left = motion.tau - predicted
    seen, contacts = noisy_reversals_masked(motion, bases, first, reversal, contacts, left)
    if seen.low_pass is not motion.low_pass:
        turning = sticking_contacts(bases, motion, prior.dry_friction(), contacts)
        Z = seen.filtered(np.concatenate([*beside, turning], 2))
    motion = seen
    at_rows = motion.recorded_rows(numbers_of_robot)
    plain = PlainNumbers(prior, at_rows, motion.at_rows(motion.qd), numbers_of_robot)
    fitter = Fitter(robot, bases, motion, Z, reversal, own, plain, resting.holds)
    scan = Scan(bases, motion, load, contacts, fitter.stated)
    selection = Selection(scan, fitter, criteria, change=change)
    steps, fit = selection.run()
    progress("conclude")
    other = None if validation is None else with_turning_motors(robot, prepare(validation))
    return _concluded(given, logs, prior, resting, selection, steps, fit, other)


def prior_of(robot: Robot, uncertainty: Uncertainty, motion: PreparedLog) -> AnyPrior:
    """What is left open about a robot's numbers: its identification's covariance, or a data
    sheet's spreads.

    Args:
        robot: as given.
        uncertainty: of a data sheet, for what an identification leaves out.
        motion: for the scales of torque and speed.
    """
    if robot.identified is not None:
        return IdentifiedPrior.of(robot, uncertainty, motion)
    return replace(BasePrior.of(robot, uncertainty, motion), common_friction=COMMON_FRICTION)


def _not_understood(robot: Robot, logs: SoundLogs, problem: LogProblem) -> Diagnosis:
    """No effect is tried on a log that is not what its columns say."""
    log = logs.used[0]
    try:
        motion = prepare(log)
    except InputError as error:
        raise InputError(f"{log.name}: {problem.says}") from error
    compared = _compared(motion, robot, robot, robot)
    return Diagnosis(
        given=robot,
        robot=robot,
        findings=(),
        unexplained=(),
        recalibrated={},
        identification=compared,
        validation=None,
        not_excited=(),
        log_problem=problem,
        left_out=logs.left_out,
    )


@lru_cache(maxsize=4)
def _bases(robot: Robot) -> Bases:
    """Bases are expensive to build and depend on the robot only."""
    return Bases(robot)


def _concluded(
    given: Robot,
    logs: SoundLogs,
    prior: AnyPrior,
    resting: Resting,
    selection: Selection,
    steps: Sequence[Step],
    fit: Fit,
    validation: PreparedLog | None,
) -> Diagnosis:
    fitter = selection.fitter
    motion = fitter.motion
    change = selection.change
    bent = of_the_whole_arm(steps, motion.n)
    searched = beside_noise(fitter, steps, fit) if bent else fit
    fit = _settled(prior, steps, searched, motion, given)
    moved = prior.updated(prior.deviations(fit.z))
    names = findings_of(prior, steps, fit, fitter, selection.scan.load, change)
    augmented = _checked(moved.with_effects(*(name.effect for name in names)))
    # what began in the middle of one record is there all through the next
    later = augmented.lasting()
    alone = _possible(prior, fitter.as_stated(fitter.fit([])))
    recalibrated = prior.updated(prior.deviations(alone.z))
    compared = _compared(motion, given, recalibrated, augmented)
    idle = tuple(int(j) + 1 for j in np.flatnonzero(rms(motion.qd) < LEAST_SPEED))
    counts = _friction_counts(motion, given, augmented, compared) if change else motion.n * [True]
    told = numbers(prior, fit, later, change=change, friction_counts=np.array(counts))
    impossible = any(one.name in BODY for one in told) and turns_impossible(given, moved)
    told = (*told, *_moved_together(selection, searched))
    if bent or selection.unsettled:
        told = tuple(one for one in told if one.list == "lacks")
    unsure = unsure_of(searched, motion)
    noise = noise_test(fitter.robot, logs.used, motion, compared.after, unsure, fit.effects)
    weak = (
        *(*logs.remarkable, *motion.from_measured),
        f"too slow in this log for much to be said: {numbered('joint', idle)}" if idle else "",
        *(*motion.remarks, *(effect.mistaken_for for effect in fit.effects)),
        *(friction_level(prior, fit), IMPOSSIBLE if impossible else ""),
        *(*resting.remarks, *selection.remarks, *noise.quick.sentences, BENT if bent else ""),
    )
    other = None if validation is None else _compared(validation, given, recalibrated, later)
    found = Diagnosis(
        given=given,
        robot=later,
        findings=suspected(names, selection.unsettled, noise.quick.moments),
        unexplained=unexplained_of(steps, fit, motion, selection.scan.load),
        recalibrated=recalibrated_terms(prior, fit, later),
        identification=compared,
        validation=other,
        not_excited=idle,
        weak=tuple(said for said in weak if said),
        numbers=told,
        change=change,
        logs=log_errors(motion, compared.before, compared.after, logs, (given, later)),
        left_out=logs.left_out,
        noise=noise,
        nameless=selection.nameless,
        unsettled=selection.unsettled,
    )
    return replace(found, weak=(*found.weak, *_read_off(found, selection)))


def _checked(robot: Robot) -> Robot:
    return Robot.model_validate(dict(robot))


def _moved_together(selection: Selection, fit: Fit) -> tuple[Number, ...]:
    """What many numbers moved as together: a load, all friction of a joint."""
    load = moved_as_by_a_load(selection.scan, selection.fitter, fit, selection.change)
    return (*load, *moved_as_all_friction(selection.fitter, fit, selection.change))


def _read_off(found: Diagnosis, selection: Selection) -> list[str]:
    """What only the whole answer tells: what it does to joints at rest, what was met too seldom."""
    wrong = found.worse_at_rest
    rest = [WORSE_AT_REST.format(joints=numbered("joint", wrong))] if wrong else []
    return [*rest, *seldom_met(found, selection.seldom)]


def _settled(
    prior: AnyPrior, steps: Sequence[Step], searched: Fit, motion: PreparedLog, given: Robot
) -> Fit:
    """The fit that is told: where nothing was found, with the given numbers if these leave no more
    of the log. A fit smooths torques, and may bend what it leaves out, as turns."""
    fit = _possible(prior, searched)
    if steps:
        return fit
    moved = prior.updated(prior.deviations(fit.z))
    before, after = (
        errors(motion.tau, predicted_torque(robot, motion, _bases(robot.bare())), motion.known).rmse
        for robot in (given, moved)
    )
    worse = np.prod(after + 1e-12) >= np.prod(before + 1e-12)
    return replace(fit, z=np.zeros_like(fit.z)) if worse else fit


def _possible(prior: AnyPrior, fit: Fit) -> Fit:
    """A fit whose numbers stay within what friction and bodies can be."""
    return with_possible_bodies(prior, with_friction_first(prior, fit))


def _friction_counts(
    motion: PreparedLog, reference: Robot, found: Robot, compared: Comparison
) -> Mask:
    """Joints whose friction may be told as another: it is, and new numbers explain them better than
    the reference's, sample by sample, the same effects beside both, shape (n,).

    Dry friction, viscous friction and inertia trade with each other in what a filter leaves of the
    turns.
    """
    same = reference.model_copy(update={"effects": found.effects})
    tau = predicted_torque(same, motion, _bases(same.bare()))
    kept = errors(motion.tau, tau, motion.known).rmse
    better = compared.error_after.rmse < (1.0 - WORTH) * kept
    return np.asarray(better & friction_is_another(reference, found, motion))


def _compared(motion: PreparedLog, before: Robot, recalibrated: Robot, after: Robot) -> Comparison:
    robots = (before, recalibrated, after)
    taus = [predicted_torque(robot, motion, _bases(robot.bare())) for robot in robots]
    found = [errors(motion.tau, tau, motion.known) for tau in taus]
    for array in (motion.time, motion.tau, *taus):
        array.setflags(write=False)
    return Comparison(
        motion.name,
        motion.time,
        motion.tau,
        taus[0],
        taus[1],
        taus[2],
        motion.known,
        found[0],
        found[1],
        found[2],
        noise_floor(motion.tau - taus[2], motion.known, motion.step),
    )
