"""What was chosen and fitted, as findings and as unexplained rests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.diagnosis.body_estimates import body_estimates
from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.comparison.confidence import (
    LOOKALIKE_CAP,
    alternatives,
    confidence,
    of_name,
)
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.curves import UNITS, binned_curve
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.carried import (
    as_carried,
    errors_as_carried,
    shares_of_the_loaded,
)
from irb2400_ctrl.diagnosis.estimation.effect_parameters import changed_of
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.finding import Finding, Unexplained
from irb2400_ctrl.diagnosis.lists import list_of
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.prior import EXACT
from irb2400_ctrl.measurement.prepared_log import PreparedLog

ACTS = 1e-3
"""share of its most on one joint from which an effect acts on another"""
ROUGHLY = 0.7
"""standard deviation of the numbers of springs and play about the true ones, over the share of its
torque that their law may leave, which the noise does not show (`benchmarks/size_errors.py` counts
how often the errors hold the true numbers)"""
NEARLY = 0.15
"""the same of the sizes of other effects"""
NO_SIZES = frozenset(("phase_rad", "start_s", "stop_s"))
"""numbers of linear laws that are none"""
ALIKE = 0.8
"""share of a stated effect's torque along that of another from which it passes for that"""


def findings_of(
    prior: AnyPrior,
    steps: Sequence[Step],
    fit: Fit,
    fitter: Fitter,
    load: Array,
    change: bool,
) -> tuple[Finding, ...]:
    """Every named effect with its numbers, their errors, its evidence and its curve.

    Args:
        load: torque of the rigid arm, shape (rows, n) [Nm]; change: whether the reference is this
            very arm on another day.
    """
    motion = fitter.motion
    found = []
    place = 0
    measured = motion.filtered_reading(motion.tau)
    loaded = shares_of_the_loaded(fit, fitter)
    for step in steps:
        for _ in step.candidate.effects:
            effect = fit.effects[place]
            torque = effect_torque(fitter.bases, effect, motion, filtered=True)
            share = _share(torque, measured)
            joint = int(np.argmax(share)) if effect.joint is None else effect.index
            instead = changed_instead(effect, torque, fitter)
            # how a transmission swings on unseen rows nobody knows
            gain = None if step.candidate.devices else _gain(step, share)
            sure = of_name(step, effect, gain, float(share.max()))
            found.append(
                Finding(
                    effect=as_carried(effect, loaded[place]),
                    standard_errors=errors_as_carried(
                        effect, _standard_errors(fit, place, step.candidate), loaded[place]
                    ),
                    confidence=min(sure, LOOKALIKE_CAP) if instead else sure,
                    alternatives=tuple(dict.fromkeys((*alternatives(step), *instead))),
                    list=list_of(effect, change),
                    gain=step.gain,
                    margin=step.margin,
                    body=body_estimates(prior, fitter, fit, place),
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
                    validation_gain=gain,
                    stated=changed_of(effect, fitter.stated),
                )
            )
            place += 1
    return tuple(found)


def changed_instead(effect: Effect, torque: Array, fitter: Fitter) -> tuple[str, ...]:
    """Kinds that the robot's file states on the joint of an effect, as large as that and of the
    same course, up to a constant: they may have become less in its place. Those of which another
    strength was among what was looked for (`of_changing_strength`) have had their turn.

    Args:
        effect: that was found; torque: of it, filtered, shape (rows, n) [Nm].
        fitter: of the log.
    """

    def course(of: Array) -> Array:
        return np.asarray(of - of.mean(axis=0))

    def alike(one: Effect) -> bool:
        other = course(effect_torque(fitter.bases, one, fitter.motion, filtered=True))
        own = course(torque)
        size = float(np.linalg.norm(own))
        return abs(float(np.sum(own * other))) > ALIKE * size * max(
            float(np.linalg.norm(other)), size
        )

    stated = [
        one
        for one in fitter.robot.effects
        if (one.chain, one.joint) == ("torque", effect.joint)
        and one.kind != effect.kind
        and changed_of(one, fitter.stated) is None
    ]
    return tuple(dict.fromkeys(one.kind for one in stated if alike(one)))


def _gain(step: Step, share: Array) -> float:
    """On unseen rows of the joint that shows it best, of those that it acts on [%]; share: of its
    torque on each joint, shape (n,)."""
    assert step.validation_gain is not None
    return float(step.validation_gain[share >= ACTS * share.max()].max())


def _share(torque: Array, measured: Array) -> Array:
    """rms of an effect over that of the joint's torque with or without it, whichever is largest:
    a balancer can take more off a joint than is left to measure."""
    size, without, whole = map(rms, (torque, measured - torque, measured))
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
    effect = fit.effects[place]
    share = effect.prior.discrepancy_share
    if share <= EXACT:
        return found
    device = bool(effect.search.device)
    rough = (ROUGHLY if device else NEARLY) * share
    sizes = set(found if device else effect.linear) - NO_SIZES
    told = effect.parameters()
    return {
        name: float(np.hypot(sigma, rough * told.get(name, 0.0))) if name in sizes else sigma
        for name, sigma in found.items()
    }


def unexplained_of(
    steps: Sequence[Step], fit: Fit, motion: PreparedLog, load: Array
) -> tuple[Unexplained, ...]:
    """Non-parametric laws, one entry per joint.

    Args:
        steps: of the selection.
        fit: of all that was chosen.
        motion: the log, prepared.
        load: torque of the rigid arm [Nm], shape (rows, n).
    """
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
        # on the rows that count for the errors: where friction turns over a law says anything
        counts = motion.at_rows(motion.known[:, joint - 1].astype(float))
        turned = candidate.against_motion
        signal = next(s for s in candidate.depends_on if not (turned and s == "qd"))
        signal = signal if signal in UNITS else "time"
        found.append(
            Unexplained(
                joint=joint,
                depends_on=candidate.depends_on,
                rmse=float(np.sqrt(counts @ torque**2 / max(counts.sum(), 1.0))),
                confidence=confidence(first),
                description=candidate.name,
                curve=binned_curve(
                    motion, load, joint - 1, signal, torque, residual, turned=turned
                ),
            )
        )
    return tuple(found)
