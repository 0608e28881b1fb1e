"""One fit of an arm to recordings: numbers, extras taken on where they gain, honest covariance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array, Integers
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.cross_validation import overall, unseen_rms
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
CLEAR = {"coupling": 10.0, "balancer": 10.0, "stribeck": 10.0, "reading": 0.0}
"""log evidence that an extra must bring [nats], the first of its kind: drives are alike. A reading
is no device of its own but the sign that plain least squares leaves a rotor"""
HARM = 0.05
"""and no joint may leave so much more on unseen stretches [-]"""
LEAST_GAIN = 0.05
"""and one that it touches must leave so much less"""
NOTHING = 1e-9
"""[Nm] what a joint that rests leaves"""
PINNED = 1e-8
"""variance, over its own, of a number that is held at zero"""

Group = tuple[Extra, ...]


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
    """What some arms have: couplings of neighbours in the wrist, balancers, readings, Stribeck."""
    couplings = [Extra("coupling", joint) for joint in range(4, n)]
    balancers = [Extra("balancer", joint) for joint in (2, 3) if joint <= n]
    single = [Extra(kind, j + 1) for kind in ("reading", "stribeck") for j in range(n)]
    return (*couplings, *balancers, *single)


def fit(model: Model, parts: Sequence[Recording], extras: Sequence[Extra] | None = None) -> Fit:
    """Fit the arm to recordings.

    Args:
        extras: what is taken on; default what gains clearly on unseen stretches.
    """
    offered = candidates(model.robot.n) if extras is None else tuple(extras)
    whole = ColumnLayout(model.robot.n, offered)
    sums = moments(model, whole, parts)
    prior = prior_of(model.robot, whole, scale_of(parts))
    layout = ColumnLayout(model.robot.n, () if extras is None else offered)
    found = _fitted(model, parts, layout, *_part(sums, prior, layout, whole))
    if extras is not None:
        return found
    chosen = _chosen(found, sums, prior, whole)
    if not chosen:
        return found
    layout = ColumnLayout(model.robot.n, chosen)
    return _fitted(model, parts, layout, *_part(sums, prior, layout, whole))


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
    first = estimate(sums, held, correlation=1.0, positive=positive, kappa=aside, rounds=5)
    factors = [
        correlation_factor(
            part.motion.tau - predicted(model, layout, part, first.theta), part.motion.known
        )
        for part in parts
    ]
    correlation = max(1.0, float(np.median(np.mean(factors, axis=0))))
    wary = estimate(sums, held, correlation=correlation, positive=positive, sigma=first.sigma)
    tried = [
        estimate(sums, held, correlation=correlation, positive=positive, start=start)
        for start in (wary, None)
    ]
    numbers = max(tried, key=lambda e: log_evidence(sums, held, e, correlation))
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


def _below(base: Fit) -> Integers:
    """Columns of the drives whose numbers would go below zero without bounds."""
    free = unbounded_minimum(base.sums, base.prior, base.numbers, base.correlation)
    return np.flatnonzero(base.layout.positive() & (free < 0.0))


def _pinned(base: Fit, prior: Prior) -> Prior:
    """The prior with those numbers held at zero that would go below without bounds."""
    drives = prior.drives.copy()
    drives[_below(base) - base.layout.inertial] *= PINNED
    return replace(prior, drives=drives)


def _offered(base: Fit, extras: Sequence[Extra]) -> list[Group]:
    """Each extra alone, and the readings of all rotors that would go below zero as one: drives are
    alike, and one reading alone is paid by the joints beside it."""
    rotor = base.layout.drive("rotor")
    below = {int(k) - rotor.start + 1 for k in _below(base) if rotor.start <= k < rotor.stop}
    readings = tuple(e for e in extras if e.kind == "reading" and e.joint in below)
    singles: list[Group] = [(extra,) for extra in extras]
    return [*singles, readings] if len(readings) > 1 else singles


def _chosen(base: Fit, sums: Moments, prior: Prior, whole: ColumnLayout) -> Group:
    """Extras one after another, the best first, while one is clear and gains unseen."""
    n = base.layout.n
    chosen: Group = ()
    open_ones = _offered(base, whole.extras)
    now = _tried(base, sums, prior, whole, base.layout)
    while open_ones:
        trials = {
            some: _tried(base, sums, prior, whole, ColumnLayout(n, (*chosen, *some)))
            for some in open_ones
        }
        like = {extra.kind for extra in chosen}
        good = [
            some
            for some in open_ones
            if _gains(some, trials[some], now)
            and trials[some].evidence
            > now.evidence + (0.0 if some[0].kind in like else CLEAR[some[0].kind])
        ]
        if not good:
            return chosen
        best = max(good, key=lambda some: trials[some].evidence)
        # what is less probable now hardly becomes clear later
        open_ones = [
            some
            for some in open_ones
            if not set(some) & set(best) and trials[some].evidence > now.evidence
        ]
        now = trials[best]
        chosen = (*chosen, *best)
    return chosen


def _gains(some: Group, trial: _Trial, now: _Trial) -> bool:
    """Whether no joint leaves more on unseen stretches, and one that they touch clearly less."""
    # a joint that rests leaves nothing, and gains nothing
    gain = np.where(now.left > NOTHING, 1.0 - trial.left / np.maximum(now.left, NOTHING), 0.0)
    if some[0].kind == "balancer":  # bodies that cannot be take its place: the evidence knows
        return bool(gain.min() > -HARM)
    touched = [joint for extra in some for joint in extra.touches]
    return bool(gain.min() > -HARM and gain[touched].max() > LEAST_GAIN)
