"""One fit of an arm to recordings: numbers, extras taken on where they gain, honest covariance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
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
from irb2400_ctrl.model import Model

ASIDE = 100.0
"""width of the bodies at which the file hardly counts"""
USUAL = 10.0
"""samples that say the same thing, before it is known"""
CLEAR = 10.0
"""log evidence that an extra must bring [nats], the first of its kind: drives are alike"""
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
        correlation: samples per independent one; sums: of the recordings, by block.
        floor: rms torque that is left when the file hardly counts [Nm], shape (n,).
    """

    layout: ColumnLayout
    prior: Prior
    sums: Moments
    numbers: Estimate
    correlation: float
    floor: Array

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
        return of(offered)
    found = of(())
    chosen = _chosen(found, sums.gathered(FOLDS), prior, whole)
    found = of(chosen) if chosen else found
    unread = _unread(found)
    if not len(unread):
        return found
    read = of((*chosen, *(readings[j] for j in unread)))
    return read if _more_probable(read, found) else found


def left_unseen(model: Model, parts: Sequence[Recording]) -> Array:
    """Rms torque that a fit without extras leaves on unseen stretches, per joint, (n,) [Nm]."""
    layout = ColumnLayout(model.robot.n)
    sums = moments(model, layout, parts)
    prior = prior_of(model.robot, layout, scale_of(parts))
    positive = layout.positive()
    like = estimate(sums, prior, correlation=USUAL, positive=positive, consistent=False)
    return overall(unseen_rms(sums, prior, like, USUAL))


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

    A wrong file would otherwise make the noise look large, and the noise would defend the file. A
    fit that starts from the file is made too; the more probable one is taken.
    """
    positive = layout.positive()
    aside = np.full(layout.n, ASIDE)
    held = _without_read_rotors(prior, layout)
    data = sums.summed()
    first = estimate(data, held, correlation=1.0, positive=positive, kappa=aside, rounds=5)
    factors = [
        correlation_factor(
            part.motion.tau - predicted(model, layout, part, first.theta), part.motion.known
        )
        for part in parts
    ]
    correlation = max(1.0, float(np.median(np.mean(factors, axis=0))))
    wary = estimate(data, held, correlation=correlation, positive=positive, sigma=first.sigma)
    tried = [
        estimate(data, held, correlation=correlation, positive=positive, start=start)
        for start in (wary, None)
    ]
    numbers = max(tried, key=lambda e: log_evidence(data, held, e, correlation))
    return Fit(layout, prior, sums, numbers, correlation, first.sigma)


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
        sigma=base.floor,
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
        like = {extra.kind for extra in chosen}
        good = [
            extra
            for extra in open_ones
            if _gains(extra, trials[extra], now)
            and trials[extra].evidence > now.evidence + (0.0 if extra.kind in like else CLEAR)
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
