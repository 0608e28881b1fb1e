"""One fit of an arm to recordings: numbers, extras taken on where they gain, honest covariance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers, Mask
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.cross_validation import FOLDS, overall, unseen_rms
from irb2400_ctrl.identification.fitting.estimate import (
    Estimate,
    estimate,
    log_evidence,
    unbounded_minimum,
)
from irb2400_ctrl.identification.fitting.moments import Moments, Recording, moments, predicted
from irb2400_ctrl.identification.fitting.noise import correlation_factor
from irb2400_ctrl.identification.fitting.prior import Prior, prior_of
from irb2400_ctrl.identification.fitting.sample_weights import student_weighted
from irb2400_ctrl.model import Model

ASIDE = 100.0
"""width of the bodies at which the file hardly counts"""
USUAL = 10.0
"""samples that say the same thing, before it is known"""
CLEAR = 10.0
"""log evidence that a balancer must bring [nats]; other extras have to gain unseen"""
NEGATIVE = 3.0
"""standard errors below zero at which a rotor is none: its drive does not read what accelerates"""
LIKE = 1.0
"""and the same of the others, once one drive is known to read so: drives are alike"""
LEAST_GAIN = 0.05
"""and so much less on unseen stretches, on the joints that it touches, for each of its numbers"""
NOTHING = 1e-9
"""[Nm] what a joint that rests leaves"""
PINNED = 1e-8
"""variance, over its own, of a number that is held at zero"""


@dataclass(frozen=True)
class Fit:
    """Numbers of a layout, and what they follow from.

    Args:
        sums: of the recordings, by block; weighted: the same of weighted samples, which the numbers
            follow from.
        correlation: samples per independent one, of each joint, shape (n,).
        free: numbers when the file hardly counts, and the torque that they leave.
        samples: the same of samples that are not weighted, no joint surer than the mean of all.
    """

    layout: ColumnLayout
    prior: Prior
    sums: Moments
    weighted: Moments
    numbers: Estimate
    correlation: Array
    free: Estimate
    samples: Array

    @property
    def theta(self) -> Array:
        """The numbers of the columns, shape (p,)."""
        return self.numbers.theta


def candidates(n: int) -> tuple[Extra, ...]:
    """What some arms have: couplings of neighbours in the wrist, balancers, Stribeck."""
    couplings = [Extra("coupling", joint) for joint in range(4, n)]
    balancers = [Extra("balancer", joint) for joint in (2, 3) if joint <= n]
    return (*couplings, *balancers, *(Extra("stribeck", j + 1) for j in range(n)))


def fit(model: Model, parts: Sequence[Recording], extras: Sequence[Extra] | None = None) -> Fit:
    """Fit the arm to recordings.

    Args:
        extras: what is taken on; default what gains clearly on unseen stretches.
    """
    n = model.robot.n
    offered = tuple(extras or ())
    readings = tuple(Extra("reading", j + 1) for j in range(n))
    if extras is None:
        offered = (*candidates(n), *readings)
    whole = ColumnLayout(n, offered)
    sums = moments(model, whole, parts)
    prior = prior_of(model.robot, whole, scale_of(parts))

    def of(chosen: Sequence[Extra]) -> Fit:
        layout = ColumnLayout(n, tuple(chosen))
        return _fitted(model, parts, layout, *_part(sums, prior, layout, whole))

    if extras is not None:
        return _settled(model, parts, of(offered))
    found = of(())
    chosen = _chosen(found, sums.gathered(FOLDS), prior, whole)
    found = of(chosen) if chosen else found
    unread = _unread(found)
    if len(unread):
        read = of((*chosen, *(readings[j] for j in unread)))
        found = read if _more_probable(read, found) else found
    return _settled(model, parts, found)


def left_unseen(model: Model, parts: Sequence[Recording]) -> Array:
    """Rms torque that a fit without extras leaves on unseen stretches, per joint, (n,) [Nm]."""
    layout = ColumnLayout(model.robot.n)
    sums = moments(model, layout, parts)
    prior = prior_of(model.robot, layout, scale_of(parts))
    positive = layout.positive()
    usual = np.full(layout.n, USUAL)
    like = estimate(sums, prior, correlation=usual, positive=positive, consistent=False)
    return overall(unseen_rms(sums, prior, like, usual))


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
    positive = layout.positive()
    aside = np.full(layout.n, ASIDE)
    held = _without_read_rotors(prior, layout)
    data = sums.summed()
    alone = np.ones(layout.n)
    first = estimate(data, held, correlation=alone, positive=positive, kappa=aside, rounds=5)
    # one for all joints: one that lacks a column would otherwise be given up before it is offered
    common = float(np.mean(_factors(model, layout, parts, first.theta)))
    correlation = np.full(layout.n, common)
    numbers = _most_probable(data, held, correlation, positive, first, alike=False)
    return Fit(layout, prior, sums, sums, numbers, correlation, first, correlation)


def _most_probable(
    data: Moments, prior: Prior, correlation: Array, positive: Mask, first: Estimate, alike: bool
) -> Estimate:
    """Of a fit that starts from noise that hardly asks the file, one that starts from it, and one
    to which all its bodies may be alike wrong."""
    wary = estimate(data, prior, correlation=correlation, positive=positive, sigma=first.sigma)
    tried = [
        estimate(data, prior, correlation=correlation, positive=positive, start=start)
        for start in (wary, None)
    ]
    if alike:
        tried.append(
            estimate(
                data, prior, correlation=correlation, positive=positive, start=wary, alike=True
            )
        )
    return max(tried, key=lambda e: log_evidence(data, prior, e, correlation))


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
    numbers = _most_probable(
        sums.summed(), held, correlation, layout.positive(), found.free, alike=True
    )
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


@dataclass(frozen=True)
class _Trial:
    """A layout tried without bounds: log evidence [nats] and what it leaves unseen [Nm]."""

    evidence: float
    left: Array


def _tried(
    base: Fit, sums: Moments, prior: Prior, whole: ColumnLayout, layout: ColumnLayout
) -> _Trial:
    places = layout.within(whole)
    part = sums.part(places)
    own = _pinned(base, prior.part(places))
    like = estimate(
        part,
        own,
        correlation=base.correlation,
        positive=layout.positive(),
        consistent=False,
        sigma=base.free.sigma,
    )
    left = overall(unseen_rms(part, own, like, base.correlation))
    return _Trial(log_evidence(part, own, like, base.correlation), left)


def _pinned(base: Fit, prior: Prior) -> Prior:
    """The prior with friction held at zero that would go below without bounds."""
    layout = base.layout
    free = unbounded_minimum(base.sums, base.prior, base.numbers, base.correlation)
    below = layout.positive() & (free < 0.0)
    below[layout.drive("rotor")] = False
    drives = prior.drives.copy()
    drives[np.flatnonzero(below) - layout.inertial] *= PINNED
    return replace(prior, drives=drives)


def _unread(base: Fit) -> Integers:
    """Zero-based joints whose rotor is below zero where it may be: their drives read the torque
    without part of what accelerates the joint."""
    layout = base.layout
    rotor = layout.drive("rotor")
    bounded = layout.positive()
    bounded[rotor] = False
    signed = estimate(
        base.sums.summed(),
        base.prior,
        correlation=base.correlation,
        positive=bounded,
        start=base.numbers,
    )
    below = -signed.theta[rotor] / np.sqrt(np.diag(signed.covariance)[rotor])
    return np.flatnonzero(below > (LIKE if below.max() > NEGATIVE else NEGATIVE))


def _more_probable(one: Fit, other: Fit) -> bool:
    """Whether the logs are more probable by the first, counted as of the correlation that the
    second leaves: a rotor below zero may as well be an axis lighter than the file says."""
    evidence = []
    for found in (one, other):
        data = found.sums.summed()
        held = _without_read_rotors(found.prior, found.layout)
        numbers = estimate(
            data,
            held,
            correlation=other.correlation,
            positive=found.layout.positive(),
            start=found.numbers,
        )
        evidence.append(log_evidence(data, held, numbers, other.correlation))
    return evidence[0] > evidence[1]


def _chosen(base: Fit, sums: Moments, prior: Prior, whole: ColumnLayout) -> tuple[Extra, ...]:
    """Extras one after another, the best first, while one is clear and gains unseen."""
    n = base.layout.n
    chosen: tuple[Extra, ...] = ()
    open_ones = list(candidates(n))
    now = _tried(base, sums, prior, whole, base.layout)
    while open_ones:
        trials = {
            extra: _tried(base, sums, prior, whole, ColumnLayout(n, (*chosen, extra)))
            for extra in open_ones
        }
        good = [
            extra
            for extra in open_ones
            if _gains(extra, trials[extra], now)
            and trials[extra].evidence - now.evidence > (CLEAR if extra.kind == "balancer" else 0.0)
        ]
        if not good:
            return chosen
        best = max(good, key=lambda extra: trials[extra].evidence)
        # what is less probable now hardly becomes clear later
        open_ones = [
            extra for extra in open_ones if extra != best and trials[extra].evidence > now.evidence
        ]
        now = trials[best]
        chosen = (*chosen, best)
    return chosen


def _gains(extra: Extra, trial: _Trial, now: _Trial) -> bool:
    """Whether the joints together leave less on unseen stretches, and those that it touches clearly
    less for the numbers that it costs."""
    moved = now.left > NOTHING  # a joint that rests leaves nothing, and gains nothing
    less = np.where(
        moved, -np.log(np.maximum(trial.left, NOTHING) / np.maximum(now.left, NOTHING)), 0.0
    )
    if extra.kind == "balancer":  # bodies that cannot be take its place: the evidence knows
        return True
    return bool(less.sum() > 0.0 and less[list(extra.touches)].mean() > LEAST_GAIN * extra.size)
