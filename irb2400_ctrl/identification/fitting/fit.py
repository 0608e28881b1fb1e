"""One fit of an arm to recordings: numbers, extras taken on where they gain, honest covariance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, rms
from irb2400_ctrl.identification.fitting.choice import PINNED, Choice, candidates
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.cross_validation import FOLDS, unseen_rms
from irb2400_ctrl.identification.fitting.estimate import Estimate, FitProblem
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.geared_motors import geared_motors, refined
from irb2400_ctrl.identification.fitting.moments import (
    Moments,
    Recording,
    faster_half,
    heavier_half,
    moments,
    predicted,
)
from irb2400_ctrl.identification.fitting.noise import NOTHING, correlation_factor
from irb2400_ctrl.identification.fitting.prior import Prior, prior_of
from irb2400_ctrl.identification.fitting.sample_weights import student_weighted
from irb2400_ctrl.model import Model

ASIDE = 100.0
"""width of the bodies at which the file hardly counts"""
USUAL = 10.0
"""samples that say the same thing, before it is known"""
NEGATIVE = 3.0
"""standard errors below zero at which a rotor is none: its drive does not read what accelerates"""
LIKE = 1.0
"""and the same of the others, once one drive is known to read so: drives are alike"""
REFINED = 2
"""times that the ratios of motors are moved beside the fit"""
IN_MOTION = (2.0, 0.6)
"""standard errors below zero, and share of what all samples say, of such a rotor where the joint is
fast: friction that is late to turn looks like one at reversals alone"""


def fit(model: Model, parts: Sequence[Recording]) -> Fit:
    """Fit the arm to recordings, with the extras that gain clearly on unseen stretches."""
    n = model.robot.n
    readings = tuple(Extra("reading", j + 1) for j in range(n))
    bare = _fitted_to(model, parts, ColumnLayout(n))
    # what such friction adds moves the bodies too little for the gears to carry another torque
    pressing = tuple(bare.theta[: bare.layout.inertial].tolist())
    motors = geared_motors(model, parts, bare)
    whole = ColumnLayout(n, (*candidates(n), *motors, *readings), pressing)
    sums = moments(model, whole, parts)
    prior = prior_of(model.robot, whole, scale_of(parts))

    def of(chosen: Sequence[Extra]) -> Fit:
        layout = replace(whole, extras=tuple(chosen))
        return _fitted(model, parts, layout, *_part(sums, prior, layout, whole))

    beyond = {
        "power": cache(lambda: moments(model, whole, faster_half(parts)).summed()),
        "load": cache(lambda: moments(model, whole, heavier_half(model, whole, parts)).summed()),
    }
    choice = Choice(bare, sums.gathered(FOLDS), beyond, prior, whole)
    chosen = choice.extras()
    found = of(chosen) if chosen else bare
    for _ in range(REFINED):
        moved = dict(zip(chosen, refined(model, parts, found), strict=True))
        if all(extra == as_moved for extra, as_moved in moved.items()):
            break
        chosen = tuple(moved.values())
        whole = replace(whole, extras=tuple(moved.get(extra, extra) for extra in whole.extras))
        sums = moments(model, whole, parts)
        found = of(chosen)
    places = found.layout.within(whole)
    unread = _unread(found, lambda: beyond["power"]().part(places))
    if len(unread):
        read = of((*chosen, *(readings[j] for j in unread)))
        found = read if _more_probable(read, found) else found
    return replace(_settled(model, parts, found), instead=choice.instead_of_bodies())


def _fitted_to(model: Model, parts: Sequence[Recording], layout: ColumnLayout) -> Fit:
    """`_fitted` with the sums and the prior of a layout."""
    prior = prior_of(model.robot, layout, scale_of(parts))
    return _fitted(model, parts, layout, moments(model, layout, parts), prior)


def left_unseen(model: Model, parts: Sequence[Recording]) -> Array:
    """Rms torque that a fit without extras leaves on unseen stretches, per joint, (n,) [Nm]."""
    layout = ColumnLayout(model.robot.n)
    sums = moments(model, layout, parts)
    prior = prior_of(model.robot, layout, scale_of(parts))
    problem = FitProblem(sums, prior, np.full(layout.n, USUAL), layout.positive())
    return rms(unseen_rms(problem, problem.estimate(consistent=False)))


def scale_of(parts: Sequence[Recording]) -> tuple[Array, Array, Array]:
    """Rms torque [Nm], speed [rad/s] and acceleration [rad/s2] of each joint, not zero."""
    motions = [part.motion for part in parts]
    found = []
    for signal, least in (("tau", 1e-3), ("qd", 1e-3), ("qdd", 1e-2)):
        values = np.concatenate([getattr(motion, signal) for motion in motions])
        found.append(np.maximum(np.sqrt(np.mean(values**2, axis=0)), least))
    return found[0], found[1], found[2]


def _part(
    sums: Moments, prior: Prior, layout: ColumnLayout, whole: ColumnLayout
) -> tuple[Moments, Prior]:
    places = layout.within(whole)
    return sums.part(places), prior.part(places)


def _fitted(
    model: Model, parts: Sequence[Recording], layout: ColumnLayout, sums: Moments, prior: Prior
) -> Fit:
    """The estimate, with noise and correlation of a first one that hardly asks the file.

    A wrong file would otherwise make the noise look large, and the noise would defend the file.
    """
    held = _without_read_rotors(prior, layout)
    problem = FitProblem(sums.summed(), held, np.ones(layout.n), layout.positive())
    first = problem.estimate(kappa=np.full(layout.n, ASIDE), rounds=5)
    # one for all joints: one that lacks a column would otherwise be given up before it is offered
    common = float(np.mean(_factors(model, layout, parts, first.theta)))
    correlation = np.full(layout.n, common)
    numbers = _most_probable(replace(problem, correlation=correlation), first, alike=False)
    return Fit(layout, prior, sums, sums, numbers, correlation, first, correlation)


def _most_probable(problem: FitProblem, first: Estimate, alike: bool) -> Estimate:
    """Of a fit that starts from noise that hardly asks the file, one that starts from it, and one
    to which all its bodies may be alike wrong."""
    wary = problem.estimate(sigma=first.sigma)
    tried = [problem.estimate(start=start) for start in (wary, None)]
    if alike:
        tried.append(problem.estimate(start=wary, alike=True))
    return max(tried, key=problem.log_evidence)


def _factors(model: Model, layout: ColumnLayout, parts: Sequence[Recording], theta: Array) -> Array:
    """Samples per independent one of what is left, of each joint, the usual log's, shape (n,)."""
    found = []
    for part in parts:
        left = part.motion.tau - predicted(model, layout, part, theta)
        seen = left if part.weight is None else part.weight * left
        found.append(correlation_factor(seen, part.motion.known))
    return np.asarray(np.maximum(np.median(found, axis=0), 1.0))


def _settled(model: Model, parts: Sequence[Recording], found: Fit) -> Fit:
    """The numbers once the columns are known: samples that few others are like, as of a start from
    rest, have less weight, and every joint its own correlation, drawn halfway to that of all.

    Noise and correlation stay those of all samples alike: what is given less weight comes in
    bursts, and errors stated without it were an eighth too small on drawn arms.
    """
    layout = found.layout
    weighted = student_weighted(model, layout, parts, found.free.theta)
    sums = moments(model, layout, weighted)
    each = _factors(model, layout, weighted, found.free.theta)
    correlation = np.sqrt(each * each.mean())
    held = _without_read_rotors(found.prior, layout)
    problem = FitProblem(sums.summed(), held, correlation, layout.positive())
    numbers = problem.averaged(_most_probable(problem, found.free, alike=True))
    plain = found.sums.summed()
    left = plain.squared_error(numbers.theta)[0] / np.maximum(plain.count[0], 1.0)
    alike = _factors(model, layout, parts, found.free.theta)
    return replace(
        found,
        weighted=sums,
        numbers=replace(numbers, sigma=np.sqrt(np.maximum(left, NOTHING**2))),
        correlation=correlation,
        samples=np.maximum(alike, alike.mean()),
    )


def _without_read_rotors(prior: Prior, layout: ColumnLayout) -> Prior:
    """The prior with the rotors held at zero whose drives do not read the accelerating torque: logs
    tell the difference of the two alone. Their uncertainty stays that of `prior`."""
    joints = [extra.joint - 1 for extra in layout.extras if extra.kind == "reading"]
    drives = prior.drives.copy()
    drives[layout.drive("rotor").start + np.array(joints, dtype=int) - layout.inertial] *= PINNED
    return replace(prior, drives=drives)


def _unread(base: Fit, fast: Callable[[], Moments]) -> Integers:
    """Zero-based joints whose rotor is below zero where it may be: their drives read the torque
    without part of what accelerates the joint.

    Args:
        base: a fit without such readings.
        fast: sums of the faster half, with its columns; asked for only where a rotor is below zero.
    """
    none = np.array([], dtype=int)
    value, error = _signed_rotors(base, base.sums.summed())
    below = -value / error
    if below.max() <= NEGATIVE:
        return none
    fast_value, fast_error = _signed_rotors(base, fast())
    clear, share = IN_MOTION
    told = (below > NEGATIVE) & (-fast_value > clear * fast_error) & (fast_value < share * value)
    return np.flatnonzero(below > LIKE) if told.any() else none


def _signed_rotors(base: Fit, data: Moments) -> tuple[Array, Array]:
    """Rotors that may be below zero, and their standard errors, shape (n,) [kg m2]."""
    rotor = base.layout.drive("rotor")
    bounded = base.layout.positive()
    bounded[rotor] = False
    problem = FitProblem(data, base.prior, base.correlation, bounded)
    signed = problem.estimate(start=base.numbers)
    return signed.theta[rotor], np.sqrt(np.diag(signed.covariance))[rotor]


def _more_probable(one: Fit, other: Fit) -> bool:
    """Whether the logs are more probable by the first, counted as of the correlation that the
    second leaves: a rotor below zero may as well be an axis lighter than the file says."""
    evidence = []
    for found in (one, other):
        held = _without_read_rotors(found.prior, found.layout)
        positive = found.layout.positive()
        problem = FitProblem(found.sums.summed(), held, other.correlation, positive)
        evidence.append(problem.log_evidence(problem.estimate(start=found.numbers)))
    return evidence[0] > evidence[1]
