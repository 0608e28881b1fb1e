"""Extras that an arm has: taken on one after another where the logs show them clearly."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.cross_validation import overall, unseen_rms
from irb2400_ctrl.identification.fitting.estimate import (
    MOST_WIDTH,
    estimate,
    log_evidence,
    unbounded_minimum,
)
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.prior import Prior

CLEAR = 10.0
"""log evidence that a balancer must bring [nats]; other extras have to gain unseen"""
LEAST_GAIN = 0.05
"""and so much less on unseen stretches, on the joints that it touches, for each of its numbers"""
NOTHING = 1e-9
"""[Nm] what a joint that rests leaves"""
PINNED = 1e-8
"""variance, over its own, of a number that is held at zero"""


def candidates(n: int) -> tuple[Extra, ...]:
    """What some arms have: couplings of neighbours in the wrist, balancers, Stribeck."""
    couplings = [Extra("coupling", joint) for joint in range(4, n)]
    balancers = [Extra("balancer", joint) for joint in (2, 3) if joint <= n]
    friction = [Extra(kind, j + 1) for kind in ("stribeck", "power") for j in range(n)]
    return (*couplings, *balancers, *friction)


def chosen_extras(base: Fit, sums: Moments, prior: Prior, whole: ColumnLayout) -> tuple[Extra, ...]:
    """Extras one after another, the best first, while one is clear and gains unseen.

    Args:
        base: the fit without any; sums: of all recordings, with the columns of all extras.
        prior: of the robot file; whole: the layout of those columns.
    """
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
            if trials[extra].evidence > now.evidence
            and trials[extra].possible
            and _shown(base, sums, prior, whole, chosen, extra, trials[extra], now)
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


def _shown(
    base: Fit,
    sums: Moments,
    prior: Prior,
    whole: ColumnLayout,
    chosen: tuple[Extra, ...],
    extra: Extra,
    trial: _Trial,
    now: _Trial,
) -> bool:
    """Whether the logs show an extra clearly.

    Bodies that cannot exist, or that the file has wrong, take the place of a balancer: there it is
    bodies that can exist, and of which the file says nothing, that must leave more without it.
    """
    if extra.kind != "balancer":
        return _gains(extra, trial, now)
    if trial.evidence - now.evidence < CLEAR:
        return False
    n = base.layout.n
    like = replace(base.free, kappa=np.full(n, MOST_WIDTH))
    left = []
    for layout in (ColumnLayout(n, chosen), ColumnLayout(n, (*chosen, extra))):
        places = layout.within(whole)
        positive = layout.positive()
        parts = (sums.part(places), prior.part(places))
        left.append(overall(unseen_rms(*parts, like, base.correlation, positive)))
    return _gains(extra, _Trial(0.0, left[1]), _Trial(0.0, left[0]))


def _gains(extra: Extra, trial: _Trial, now: _Trial) -> bool:
    """Whether the joints together leave less on unseen stretches, and those that it touches clearly
    less for the numbers that it costs."""
    moved = now.left > NOTHING  # a joint that rests leaves nothing, and gains nothing
    less = np.where(
        moved, -np.log(np.maximum(trial.left, NOTHING) / np.maximum(now.left, NOTHING)), 0.0
    )
    return bool(less.sum() > 0.0 and less[list(extra.touches)].mean() > LEAST_GAIN * extra.size)


@dataclass(frozen=True)
class _Trial:
    """A layout tried without bounds: log evidence [nats], what it leaves unseen [Nm], and whether
    numbers of its extras that cannot be negative are not."""

    evidence: float
    left: Array
    possible: bool = True


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
    added = layout.positive()[layout.inertial + 4 * layout.n :]
    possible = bool((like.theta[layout.inertial + 4 * layout.n :][added] > 0.0).all())
    return _Trial(log_evidence(part, own, like, base.correlation), left, possible)


def _pinned(base: Fit, prior: Prior) -> Prior:
    """The prior with friction held at zero that would go below without bounds."""
    layout = base.layout
    free = unbounded_minimum(base.sums, base.prior, base.numbers, base.correlation)
    below = layout.positive() & (free < 0.0)
    below[layout.drive("rotor")] = False
    drives = prior.drives.copy()
    drives[np.flatnonzero(below) - layout.inertial] *= PINNED
    return replace(prior, drives=drives)
