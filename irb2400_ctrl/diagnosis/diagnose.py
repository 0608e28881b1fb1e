"""`diagnose`: from a robot and a log to what the robot has and its model lacks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.comparison.confidence import alternatives, confidence
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.comparison.selection import Selection, reversal_rows
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.curves import UNITS, binned_curve
from irb2400_ctrl.diagnosis.diagnosis import Comparison, Diagnosis, Finding, Unexplained
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.reversals import noisy_reversals_masked
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.diagnosis.preparation.metrics import errors, noise_floor
from irb2400_ctrl.diagnosis.preparation.moved_numbers import moved_numbers
from irb2400_ctrl.diagnosis.preparation.noise_test import noise_test
from irb2400_ctrl.diagnosis.recalibrated import recalibrated_terms
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque, predicted_torque
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.plausibility import LogProblem, log_problem
from irb2400_ctrl.robot import Robot, Uncertainty

LEAST_SPREAD = 0.25
"""what a reference log leaves uncertain at least, in data-sheet standard deviations"""
COMMON_FRICTION = 0.3
"""standard deviation of the friction of all joints together, over the file's: temperature"""
LEAST_SECONDS = 3.0
"""a shorter log is not diagnosed"""
LEAST_SPEED = 0.05
"""[rad/s] rms speed of a joint below which nothing can be said about it"""


def diagnose(
    robot: Robot,
    log: Log,
    validation: Log | None = None,
    reference: Log | None = None,
    *,
    uncertainty: Uncertainty | None = None,
    criteria: Criteria | None = None,
    progress: Callable[[str], None] = lambda stage: None,
) -> Diagnosis:
    """What the robot has and its model lacks.

    Args:
        robot: the model as it is believed to be.
        log: of the motion to explain; a wide, lively motion of all joints tells most.
        validation: another motion of the same arm; only the errors before and after are computed on
            it.
        reference: of the same arm when nothing was wrong: what the log shows is then judged against
            it, with the arm's own parameters instead of the data sheet's.
        uncertainty: of the robot's numbers; default data-sheet values.
        criteria: when an explanation counts.
        progress: told the name of each stage.

    Raises:
        InputError: the log does not fit the robot, is too short, or is broken; validation or
            reference are not understood.
    """
    # the matrices are small: threads would only wait for each other
    with threadpool_limits(limits=1, user_api="blas"):
        progress("understand")
        problem = _problem(robot, log, validation, reference)
        if problem is not None:
            return _not_understood(robot, log, problem)
        progress("prepare")
        motion = prepare(log)
        bases = _bases(robot.bare())
        base_prior = replace(
            BasePrior.of(robot, uncertainty or robot.uncertainty, motion),
            common_friction=COMMON_FRICTION,
        )
        if reference is not None:
            base_prior = _referred(base_prior, bases, prepare(reference))
        Z = motion.filtered(base_prior.columns(bases.model, motion))
        load = bases.model.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
        progress("scan")
        reversal = reversal_rows(motion)
        offset = base_prior.offset(bases.model, motion)
        first = Fitter(robot, bases, motion, Z, reversal, offset).fit([])
        motion = noisy_reversals_masked(motion, bases, first, reversal)
        scan = Scan(bases, motion, load)
        fitter = Fitter(robot, bases, motion, Z, reversal, offset)
        steps, fit = Selection(scan, fitter, criteria).run()
        progress("conclude")
        return _concluded(
            robot,
            base_prior,
            motion,
            load,
            bases,
            steps,
            fit,
            None if validation is None else prepare(validation),
            log,
        )


def _problem(
    robot: Robot, log: Log, validation: Log | None, reference: Log | None
) -> LogProblem | None:
    """Why the log is not what its columns say; the logs beside it must be sound."""
    for one in (log, validation, reference):
        if one is not None and one.n != robot.n:
            raise InputError(
                f"{one.name}: found {one.n} joints, expected {robot.n} as in {robot.name}"
            )
    if log.duration < LEAST_SECONDS:
        raise InputError(
            f"{log.name}: found {log.duration:.2f} s of data, expected at least "
            f"{LEAST_SECONDS:.0f} s to tell one effect from another; record a longer motion"
        )
    problem = log_problem(robot, log)
    if problem is not None and problem.unusable:
        raise InputError(f"{log.name}: {problem.says}")
    for other in (validation, reference):
        wrong = None if other is None else log_problem(robot, other)
        if other is not None and wrong is not None and problem is None:
            raise InputError(f"{other.name}: {wrong.says}; try `irb2400 log check`")
    return problem


def _not_understood(robot: Robot, log: Log, problem: LogProblem) -> Diagnosis:
    """No effect is tried on a log that is not what its columns say."""
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
        noise_floor=noise_floor(motion.tau - compared.after, motion.known, motion.step),
        not_excited=(),
        log_problem=problem,
    )


def _referred(base_prior: BasePrior, bases: Bases, motion: PreparedLog) -> BasePrior:
    """The arm's numbers as a log without anything wrong settles them, with what uncertainty it
    leaves."""
    Z = motion.filtered(base_prior.columns(bases.model, motion))
    fit = Fitter(base_prior.robot, bases, motion, Z, reversal_rows(motion)).fit([])
    # the arm of another day is never quite the same: friction moves with temperature
    return replace(
        base_prior,
        centre=base_prior.deviations(fit.z),
        spread=np.maximum(INFLATION * base_prior.deviation_errors(fit.z_covariance), LEAST_SPREAD),
    )


@lru_cache(maxsize=4)
def _bases_of(text: str) -> Bases:
    return Bases(Robot.model_validate_json(text))


def _bases(robot: Robot) -> Bases:
    """Bases are expensive to build and depend on the robot only."""
    return _bases_of(robot.model_dump_json())


def _concluded(
    robot: Robot,
    base_prior: BasePrior,
    motion: PreparedLog,
    load: Array,
    bases: Bases,
    steps: Sequence[Step],
    fit: Fit,
    validation: PreparedLog | None,
    log: Log,
) -> Diagnosis:
    fresh = base_prior.updated(base_prior.deviations(fit.z))
    recalibrated = fresh.model_copy(update={"effects": robot.effects})
    augmented = Robot.model_validate({**dict(fresh), "effects": (*robot.effects, *fit.effects)})
    # what began in the middle of one record is there all through the next
    later = augmented.lasting()
    compared = [_compared(motion, robot, recalibrated, augmented)]
    if validation is not None:
        compared.append(_compared(validation, robot, recalibrated, later))
    idle = tuple(
        j + 1 for j in range(motion.n) if np.sqrt(np.mean(motion.qd[:, j] ** 2)) < LEAST_SPEED
    )
    floor = noise_floor(motion.tau - compared[0].after, motion.known, motion.step)
    weak = (
        []
        if motion.instrumented
        else ["no commanded motion (q_ref) explains the measured one: regressors carry noise"]
    )
    weak += [f"joint {j} is not excited" for j in idle]
    return Diagnosis(
        given=robot,
        robot=later,
        findings=_findings(steps, fit, motion, load, bases),
        unexplained=_unexplained(steps, fit, motion, load),
        recalibrated=recalibrated_terms(base_prior, fit, later),
        identification=compared[0],
        validation=None if validation is None else compared[1],
        noise_floor=floor,
        not_excited=idle,
        weak=tuple(weak),
        noise=noise_test(robot, log, motion, compared[0].after),
        moved=moved_numbers(robot, fit.z),
    )


def _compared(motion: PreparedLog, before: Robot, recalibrated: Robot, after: Robot) -> Comparison:
    taus = [predicted_torque(robot, motion) for robot in (before, recalibrated, after)]
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
    )


def _findings(
    steps: Sequence[Step], fit: Fit, motion: PreparedLog, load: Array, bases: Bases
) -> tuple[Finding, ...]:
    found = []
    place = 0
    measured = motion.filtered(motion.tau)
    for step in steps:
        for _ in step.candidate.effects:
            effect = fit.effects[place]
            torque = effect_torque(bases, effect, motion, filtered=True)
            share = _share(torque, measured)
            joint = int(np.argmax(share)) if effect.joint is None else effect.index
            found.append(
                Finding(
                    effect=effect,
                    standard_errors=_standard_errors(fit, place, step.candidate),
                    confidence=confidence(step),
                    alternatives=alternatives(step),
                    gain=step.gain,
                    margin=step.margin,
                    share=share,
                    curve=binned_curve(
                        motion,
                        load,
                        joint,
                        effect.drawing.abscissa,
                        torque[:, joint],
                        fit.residual[:, joint],
                        period=effect.period,
                        turned=effect.drawing.against_motion,
                    ),
                    validation_gain=float(_gain(step)[joint]),
                )
            )
            place += 1
    return tuple(found)


def _gain(step: Step) -> Array:
    assert step.validation_gain is not None
    return step.validation_gain


def _share(torque: Array, measured: Array) -> Array:
    """rms of an effect over that of the joint's torque with or without it, whichever is largest:
    a balancer can take more off a joint than is left to measure."""
    size, without, whole = (
        np.sqrt(np.mean(tau**2, axis=0)) for tau in (torque, measured - torque, measured)
    )
    whole = np.where(size > whole, np.maximum(size, without), whole)
    return np.asarray(size / np.maximum(whole, 1e-9))


def _standard_errors(fit: Fit, place: int, candidate: Candidate) -> dict[str, float | list[float]]:
    found: dict[str, Any] = {name: INFLATION * sigma for name, sigma in candidate.spread.items()}
    for parameter, sigma in zip(fit.parameters, fit.sigma, strict=True):
        if parameter.effect == place:
            value = float(INFLATION * sigma)
            if parameter.element is None:
                found[parameter.name] = value
            else:
                found.setdefault(parameter.name, []).append(value)
    return found


def _unexplained(
    steps: Sequence[Step], fit: Fit, motion: PreparedLog, load: Array
) -> tuple[Unexplained, ...]:
    """Non-parametric laws, one entry per joint."""
    by_joint: dict[int, list[tuple[Step, Array]]] = {}
    non_parametric = iter(fit.non_parametric)
    for step in steps:
        if not step.candidate.known:
            by_joint.setdefault(step.candidate.joint or 1, []).append((step, next(non_parametric)))
    found = []
    for joint, parts in by_joint.items():
        torque = np.sum([tau for _, tau in parts], axis=0)[:, joint - 1]
        residual = fit.residual[:, joint - 1]
        first = max(parts, key=lambda part: part[0].gain)[0]
        candidate: Candidate = first.candidate
        signal = candidate.depends_on[0] if candidate.depends_on[0] in UNITS else "time"
        found.append(
            Unexplained(
                joint=joint,
                depends_on=candidate.depends_on,
                rmse=float(np.sqrt(np.mean(torque**2))),
                confidence=confidence(first),
                description=candidate.name,
                curve=binned_curve(motion, load, joint - 1, signal, torque, residual),
            )
        )
    return tuple(found)
