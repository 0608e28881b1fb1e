"""`identify`: a robot that is true, from sound logs of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, one_thread
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.constant_runs import Run, runs_of
from irb2400_ctrl.identification.fitting.baseline import plain_least_squares
from irb2400_ctrl.identification.fitting.columns import ColumnLayout
from irb2400_ctrl.identification.fitting.covariance import block_covariance, open_between_logs
from irb2400_ctrl.identification.fitting.fit import fit, left_unseen
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.given import given_torque
from irb2400_ctrl.identification.fitting.moments import Recording, predicted
from irb2400_ctrl.identification.fitting.motion_source import Source
from irb2400_ctrl.identification.fitting.zeros import other_zeros
from irb2400_ctrl.identification.force_sensor import SensedLoad, sensed_load, with_load
from irb2400_ctrl.identification.friction_curve import (
    FrictionCurve,
    friction_curves,
    log_of_runs,
    with_curves,
    with_run_samples,
)
from irb2400_ctrl.identification.gains import (
    Gains,
    gains_of_file,
    gains_of_others,
    open_by_gain,
    without_gains,
)
from irb2400_ctrl.identification.gate import verdicts
from irb2400_ctrl.identification.guessed_bodies import (
    GUESSED,
    said_of_inertias,
    with_guessed_bodies,
    with_guessed_inertias,
    without_inertia,
)
from irb2400_ctrl.identification.held_out import held_out, slowly_left
from irb2400_ctrl.identification.identification import Identification, LogResult
from irb2400_ctrl.identification.identified_robot import fit_base, identified_robot
from irb2400_ctrl.identification.known_load.gains_from_load import weighed_load
from irb2400_ctrl.identification.late_torques import (
    Late,
    delays,
    in_robot,
    open_by_delay,
    prepared,
)
from irb2400_ctrl.identification.moved import moved_bodies
from irb2400_ctrl.identification.notes import notes_of, of_the_bodies, resting
from irb2400_ctrl.identification.odd_logs import odd_logs
from irb2400_ctrl.identification.understood_logs import (
    borne_out,
    said_of,
    understood_logs,
)
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.plausibility import unknown_bodies
from irb2400_ctrl.plausibility.columns.channels import NO_MOTION
from irb2400_ctrl.robot import Body, Identified, Robot
from irb2400_ctrl.typed import typed

Logs = Sequence[Log]
Fitted = tuple[Identification, Fit]

CLEARER = 0.03
"""recorded speed is used when it leaves so much less than differentiated angles [-]"""

SAME = 1e-9
"""of the largest torque: rounding between the fit and the robot that it becomes"""


@typed
def identify(
    robot: Robot,
    logs: Log | Sequence[Log],
    *,
    validation: Log | Sequence[Log] = (),
    loaded: Log | Sequence[Log] = (),
    load: Body | None = None,
) -> Identification:
    """Bodies, friction, offsets and rotors of an arm from one or several logs of it.

    Bodies are possible ones; the file counts with the widths that it states, wider where the logs
    say so. Couplings of the wrist, a balancer, friction of other laws and readings without the
    accelerating torque are taken on where the logs show them clearly. Friction at low speed comes
    from stretches in which one joint moves at constant speed, forth and back (eqs. 70-74), where
    the logs hold such; the tool from a force sensor at the flange, where they hold its columns.

    Args:
        robot: the file; its effects stay, but offsets, rotors and couplings are fitted anew.
        logs: motions of the sound arm; validation: others, for the error only.
        loaded: the same arm with a load that was weighed; load: its body in the axes of the flange.
            They give the gains of the torque channels; the arm is then in true Nm. Without them
            only what the channels have apart is found, where the logs show it clearly.

    Raises:
        InputError: no log or none that is what its columns say, a load without its logs, another
            number of joints, or an effect of the file whose torque depends on the numbers that are
            fitted.
    """
    # matrices of a hundred numbers: threads cost more than they bring
    with one_thread():
        seen, others, heavy = (
            [some] if isinstance(some, Log) else list(some) for some in (logs, validation, loaded)
        )
        if (load is None) == bool(heavy):
            raise InputError(
                "identify: found a load without logs of it, or logs without its mass and centre; "
                "expected both (--loaded LOG --load KG,X,Y,Z)"
            )
        _check(robot, [*seen, *heavy])
        if load is not None:
            return _in_true_torque(robot, seen, others, *weighed_load(robot, seen, heavy, load))
        gains = gains_of_file(robot)
        if gains is None:
            found, fitted = _identified(robot, seen, others, None)
            gains = gains_of_others(fitted)
            if gains is None:
                return found
        return _in_true_torque(robot, seen, others, gains)


def _in_true_torque(
    robot: Robot, seen: Logs, others: Logs, gains: Gains, said: Sequence[str] = ()
) -> Identification:
    """The fit to torques over the gains of their channels; the robot says what is read.

    Args:
        robot: the file.
        seen, others: logs to fit and to judge by.
        gains: of the channels; said: of the logs that they are from.
    """
    true, judges = ([gains.applied(log) for log in some] for some in (seen, others))
    found, fitted = _identified(without_gains(robot), true, judges, gains)
    known = gains.in_robot(found.robot)
    notes = [*found.notes, *said, *gains.says(), *gains.doubted_by(fitted)]
    return replace(found, given=robot, robot=known, gains=gains, notes=notes)


def _identified(robot: Robot, seen: Logs, others: Logs, gains: Gains | None) -> Fitted:
    """The arm, and the fit."""
    _check(robot, [*seen, *others])
    sound = understood_logs(robot, seen)
    beside = understood_logs(robot, others)
    runs = [runs_of(log) for log in sound.logs]
    curves = friction_curves([run for some in runs for run in some])
    sensed = sensed_load(robot, sound.logs)
    # a placeholder says nothing of the friction that is looked for
    guessed = unknown_bodies(robot)
    whole = with_guessed_inertias(with_guessed_bodies(robot, sound.logs))
    stated = whole.with_unknown_friction(sound.other_friction)
    base, kept = fit_base(with_load(with_curves(stated, curves), sensed))
    model = Model(base)
    late = delays(model, kept, sound.logs)
    source, parts = _recorded(model, kept, sound.logs, late)
    parts = _with_runs(parts, runs, curves)
    found = fit(model, parts)
    covariance = block_covariance(found.sums, found.prior, found.numbers, found.samples)
    covariance += open_by_delay(model, found, parts, late) + open_by_gain(found, gains)
    covariance += open_between_logs(found, parts)
    fitted, said = identified_robot(kept, found.layout, found.theta)
    _agree(fitted, kept, parts[0], predicted(model, found.layout, parts[0], found.theta))
    moved = [] if guessed else moved_bodies(base, found, covariance, without_inertia(robot))
    told = verdicts(model, found.layout, found.sums, found.numbers.sigma, found.samples)
    results = _judged(model, robot, found, parts, [log_of_runs(log, curves) for log in sound.logs])
    known = _known(found, covariance, results)
    late_beside = delays(model, kept, beside.logs)
    parts_beside = given_torque(kept, prepared(beside.logs, source, late_beside))
    results += _validated(model, robot, found, parts_beside)
    against = [one.says() for one in other_zeros(model, found, parts)]
    against += [*borne_out(sound, results), *odd_logs(found, parts)]
    told_late = [one for one in (*late, *late_beside) if one is not None]
    identified = Identification(
        given=robot,
        robot=in_robot(fitted.model_copy(update={"identified": known}), late),
        layout=found.layout,
        theta=found.theta,
        covariance=covariance,
        source=source,
        sigma=found.numbers.sigma,
        correlation=float(found.correlation.mean()),
        moved=moved,
        verdicts=told,
        logs=results,
        notes=[
            *said_of(sound, beside, robot=fitted),
            *against,
            *(one.says() for one in told_late),
            *([GUESSED.format(why=guessed)] if guessed else said_of_inertias(robot)),
            *notes_of(moved, found, covariance, said),
            *resting(told),
            *_recorded_how(parts, curves, sensed),
        ],
        friction=curves,
        sensed=sensed,
        of_bodies=of_the_bodies(moved, results, bool(against or said or not moved)),
        late=told_late,
    )
    return identified, found


def _with_runs(
    parts: Sequence[Recording], runs: Sequence[Sequence[Run]], curves: Sequence[FrictionCurve]
) -> list[Recording]:
    """The recordings with the samples of their runs at constant speed."""
    return [
        replace(part, motion=with_run_samples(part.motion, some, curves))
        for part, some in zip(parts, runs, strict=True)
    ]


def _known(found: Fit, covariance: Array, results: Sequence[LogResult]) -> Identified:
    """How surely the numbers are known, for the robot file."""
    names = [result.name for result in results]
    return Identified.of(found.layout.names(), covariance, names, slowly_left(results))


def _recorded_how(
    parts: Sequence[Recording], curves: Sequence[FrictionCurve], sensed: SensedLoad | None
) -> list[str]:
    """Remarks on how the logs were recorded, and what their runs and their sensor tell."""
    return [
        *dict.fromkeys(remark for part in parts for remark in part.motion.remarks),
        *(curve.says() for curve in curves),
        *([] if sensed is None else sensed.says()),
    ]


def _check(robot: Robot, logs: Sequence[Log]) -> None:
    if not logs:
        raise InputError("identify: found no log, expected at least one of the sound arm")
    for log in logs:
        if log.n != robot.n:
            raise InputError(
                f"{log.name}: found {log.n} joints, expected the {robot.n} of {robot.name}; give "
                "the robot of this log (--robot)"
            )
        if np.ptp(log.q, axis=0).max() < NO_MOTION:
            raise InputError(
                f"{log.name}: no joint moves, expected a motion of all joints "
                "(`irb2400 excite --for identify` makes one)"
            )


def _agree(fitted: Robot, kept: Robot, part: Recording, torque: Array) -> None:
    """The robot must say what was fitted."""
    off = np.abs(predicted_torque(fitted, part.motion) - torque).max()
    if off > SAME * np.abs(torque).max():
        kinds = ", ".join(sorted({effect.kind for effect in kept.effects}))
        raise InputError(
            f"identify: the torque of the file's effects ({kinds}) depends on the bodies that are "
            "fitted; take these effects out of the robot file, identify, and diagnose them then"
        )


def _recorded(
    model: Model, kept: Robot, logs: Sequence[Log], late: Sequence[Late | None]
) -> tuple[Source, list[Recording]]:
    """Where speeds are taken from, and the recordings with what the file knows beside the fit."""
    sources: list[Source] = ["angle"]
    if any(log.qd is not None for log in logs):
        sources.append("speed")
    tried = {source: given_torque(kept, prepared(logs, source, late)) for source in sources}
    if len(tried) == 1:
        return "angle", tried["angle"]
    left = {}
    for source, parts in tried.items():
        left[source] = left_unseen(model, parts)
    # a joint that did not move leaves nothing to compare
    told = (left["speed"] > 0.0) & (left["angle"] > 0.0)
    gain = 1.0 - np.exp(np.mean(np.log(left["speed"][told] / left["angle"][told])))
    best: Source = "speed" if gain > CLEARER else "angle"
    return best, tried[best]


def _judged(
    model: Model, robot: Robot, found: Fit, parts: Sequence[Recording], slow: Sequence[bool]
) -> list[LogResult]:
    """The logs of the identification, each stretch predicted by a fit that had not seen it."""
    unseen, plain = held_out(model, found, parts, slow)
    return [
        _result(model, robot, found, part, "identification", ours, theirs)
        for part, ours, theirs in zip(parts, unseen, plain, strict=True)
    ]


def _validated(
    model: Model, robot: Robot, found: Fit, parts: Sequence[Recording]
) -> list[LogResult]:
    """Other logs, by the fit to all logs of the identification."""
    bare = ColumnLayout(found.layout.n)
    shortest = plain_least_squares(found.sums.part(bare.within(found.layout)))
    results = []
    for part in parts:
        ours = predicted(model, found.layout, part, found.theta)
        theirs = predicted(model, bare, part, shortest)
        results.append(_result(model, robot, found, part, "validation", ours, theirs))
    return results


def _result(
    model: Model,
    robot: Robot,
    found: Fit,
    part: Recording,
    role: str,
    unseen: Array,
    plain: Array,
) -> LogResult:
    motion = part.motion
    return LogResult(
        name=motion.name,
        role=role,
        time=motion.time,
        q=motion.q,
        qd=motion.qd,
        measured=motion.tau,
        known=motion.known,
        before=predicted_torque(robot, motion),
        fitted=predicted(model, found.layout, part, found.theta),
        unseen=unseen,
        plain=plain,
    )
