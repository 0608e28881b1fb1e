"""Extras that an arm has: taken on one after another where the logs show them clearly."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.identification.fitting.columns import COUPLED, ColumnLayout, Extra
from irb2400_ctrl.identification.fitting.cross_validation import unseen_rms
from irb2400_ctrl.identification.fitting.estimate import MOST_WIDTH, Estimate, FitProblem
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.noise import NOTHING
from irb2400_ctrl.identification.fitting.prior import Prior

BALANCED = (2, 3)
"""joints that carry the arm, where what pulls towards one angle is a balancer"""
LIKE_BODIES = ("balancer", "spring")
"""kinds whose torque bodies that the file has wrong make as well"""
CLEAR = 10.0
"""log evidence that what bodies could be must bring [nats]; other extras have to gain unseen"""
LEAST_GAIN = 0.05
"""and so much less on unseen stretches, on the joints that it touches, for each of its numbers"""
SURE = 3.0
"""standard errors from nothing of a gear's loss: as large a one as in many a file hardly shows"""
MOST_LOSS = 0.15
"""of the torque that a gear carries, lost to dry friction on top of what it always has [-]"""
SPREAD = 0.2
"""of the speeds of a joint over their mean, below which they are one speed: a log that moves at one
has 0.05 to 0.10, others 0.28 and more, on twelve foreign arms and five real ones"""
PINNED = 1e-8
"""variance, over its own, of a number that is held at zero"""


def candidates(n: int) -> tuple[Extra, ...]:
    """What some arms have: couplings in the wrist, balancers, hoses that pull like a spring,
    friction of other laws."""
    couplings = [
        Extra(kind, joint) for kind, effect in COUPLED.items() for joint in effect.joints(n)
    ]
    balancers = [Extra("balancer", joint) for joint in BALANCED if joint <= n]
    friction = [Extra(kind, j + 1) for kind in ("stribeck", "power", "load") for j in range(n)]
    # within half a turn either passes for the other
    hoses = [Extra("spring", j + 1) for j in range(n) if j + 1 not in BALANCED]
    return (*couplings, *balancers, *hoses, *friction)


@dataclass(frozen=True)
class Choice:
    """What extras are chosen from.

    Args:
        base: the fit without any; sums: of all recordings, with the columns of all extras.
        beyond: the same of the half of the samples, one block, into which a kind must reach from
            the other: the faster of each joint, the heavier laden.
        prior: of the robot file; whole: the layout of those columns.
    """

    base: Fit
    sums: Moments
    beyond: Mapping[str, Callable[[], Moments]]
    prior: Prior
    whole: ColumnLayout

    def extras(self) -> tuple[Extra, ...]:
        """Those that leave less unseen: with motors that other axes turn among them, or without,
        where couplings are what such gears look like."""
        return self._chosen.layout.extras

    def instead_of_bodies(self) -> tuple[Extra, ...]:
        """Balancers that are none of `extras`, as bodies that can exist say the same, and beside
        which the file's bodies are clearly more probable."""
        chosen = self.extras()
        found = []
        for extra in candidates(self.base.layout.n):
            if extra.kind == "balancer" and extra not in chosen:
                more = self._tried((*chosen, extra)).evidence - self._chosen.evidence
                found += [(more, extra)] * (more > CLEAR)
        return tuple(extra for _, extra in sorted(found, key=lambda one: -one[0]))

    @cached_property
    def _chosen(self) -> _Trial:
        usual = candidates(self.base.layout.n)
        motors = [extra for extra in self.whole.extras if extra.kind == "motor"]
        without = self._among([*usual])
        with_motors = self._among([*usual, *motors]) if motors else without
        return min(without, with_motors, key=_all_left)

    def _among(self, open_ones: list[Extra]) -> _Trial:
        """One after another, the best first, while one is clear and gains unseen."""
        chosen: tuple[Extra, ...] = ()
        now = self._tried(())
        while open_ones:
            trials = {extra: self._tried((*chosen, extra)) for extra in open_ones}
            good = [
                extra
                for extra in open_ones
                if _may_be(extra, chosen)
                and trials[extra].evidence > now.evidence
                and trials[extra].possible
                and self._shown(extra, trials[extra], now)
            ]
            if not good:
                break
            best = max(good, key=lambda extra: trials[extra].evidence)
            # what is less probable now hardly becomes clear later
            open_ones = [
                extra
                for extra in open_ones
                if extra != best and trials[extra].evidence > now.evidence
            ]
            now = trials[best]
            chosen = (*chosen, best)
        return now

    def _shown(self, extra: Extra, trial: _Trial, now: _Trial) -> bool:
        """Whether the logs show an extra clearly.

        Bodies that cannot exist, or that the file has wrong, take the place of a balancer or a
        hose: there it is bodies that can exist, and of which the file says nothing, that must leave
        more without it, or weigh what no link does. Friction that bends, or grows with load, must
        not lead astray where there is more of it.
        """
        if extra.kind == "load" and not _gear_could(extra, trial):
            return False
        if extra.kind == "stribeck" and not self._slow_enough(extra):
            return False
        if extra.kind == "power" and not self._speeds_apart(extra):
            return False
        if extra.kind in self.beyond:
            return _gains(extra, trial, now) and self._reaches_further(extra, trial, now)
        if extra.kind not in LIKE_BODIES:
            return _gains(extra, trial, now)
        if trial.evidence - now.evidence < CLEAR:
            return False
        if extra.kind == "balancer" and self._absurd(now) and not self._absurd(trial):
            return True
        like = replace(self.base.free, kappa=np.full(self.base.layout.n, MOST_WIDTH))
        left = []
        for layout in (now.layout, trial.layout):
            places = layout.within(self.whole)
            problem = self._problem(layout, self.sums.part(places), self.prior.part(places))
            left.append(rms(unseen_rms(problem, like, bounded=True)))
        return _gains(extra, replace(trial, left=left[1]), replace(now, left=left[0]))

    def _absurd(self, one: _Trial) -> bool:
        """Whether a link would weigh what it cannot, bodies being possible ones."""
        sums = self.sums.part(one.layout.within(self.whole))
        problem = self._problem(one.layout, sums, one.prior)
        theta = problem.estimate(sigma=self.base.free.sigma).theta
        return bool(one.prior.absurd(theta).any())

    def _slow_enough(self, extra: Extra) -> bool:
        """Whether samples show friction at low speed where it is: those at which its bell counts,
        at more than 1 / e of it. From its foot alone anything may rise to any height at rest."""
        j = extra.joint - 1
        (bell,) = range(self.whole.count)[self.whole.extra(extra)]
        seen = self.sums.H[:, j].sum(axis=0)
        return bool(seen[bell, bell] * np.e > seen[bell, self.whole.drive("coulomb").start + j])

    def _speeds_apart(self, extra: Extra) -> bool:
        """Whether the joint moves at speeds apart, N sum w^2 > (1 + `SPREAD`^2) (sum |w|)^2: at
        one speed a curve through its friction there may bend in any way."""
        j = extra.joint - 1
        seen = self.sums.H[:, j].sum(axis=0)
        dry = self.whole.drive("coulomb").start + j
        viscous = self.whole.drive("viscous").start + j
        mean_square = seen[dry, dry] * seen[viscous, viscous]
        return bool(mean_square > (1.0 + SPREAD**2) * seen[dry, viscous] ** 2)

    def _reaches_further(self, extra: Extra, trial: _Trial, now: _Trial) -> bool:
        """Whether it may cost no more at speeds, or loads, that it has not seen than it takes off
        at those that it has: fitted to the lower half, held against the upper."""
        j = extra.joint - 1
        upper = [self._left_beyond(extra.kind, one)[j] for one in (trial, now)]
        return bool(upper[0] * trial.left[j] < upper[1] * now.left[j])

    def _left_beyond(self, kind: str, one: _Trial) -> Array:
        """Rms torque that is left on the upper half by a fit to the lower, shape (n,) [Nm]."""
        places = one.layout.within(self.whole)
        upper = self.beyond[kind]().part(places)
        lower = self.sums.part(places).summed().less(upper)
        theta = self._problem(one.layout, lower, one.prior).unbounded_minimum(one.like)
        count = np.maximum(upper.count[0], 1.0)
        return np.asarray(np.sqrt(upper.squared_error(theta)[0] / count))

    def _tried(self, extras: tuple[Extra, ...]) -> _Trial:
        """These extras without bounds."""
        base = self.base
        layout = replace(self.whole, extras=extras)
        places = layout.within(self.whole)
        own = _pinned(base, self.prior.part(places))
        problem = self._problem(layout, self.sums.part(places), own)
        like = problem.estimate(consistent=False, sigma=base.free.sigma)
        left = rms(unseen_rms(problem, like))
        first = layout.inertial + 4 * layout.n
        added = problem.positive[first:]
        possible = bool((like.theta[first:][added] > 0.0).all())
        return _Trial(layout, own, like, problem.log_evidence(like), left, possible)

    def _problem(self, layout: ColumnLayout, sums: Moments, prior: Prior) -> FitProblem:
        return FitProblem(sums, prior, self.base.correlation, layout.positive())


@dataclass(frozen=True)
class _Trial:
    """A layout tried without bounds: its prior and numbers, log evidence [nats], what it leaves
    unseen [Nm], and whether numbers of its extras that cannot be negative are not."""

    layout: ColumnLayout
    prior: Prior
    like: Estimate
    evidence: float
    left: Array
    possible: bool


def _all_left(trial: _Trial) -> float:
    """Log of what is left unseen, the joints' sum."""
    return float(np.log(np.maximum(trial.left, NOTHING)).sum())


def _may_be(extra: Extra, chosen: Sequence[Extra]) -> bool:
    """Whether there is what it is never without (`Search.beside`)."""
    beside = COUPLED[extra.kind].search.beside if extra.kind in COUPLED else ""
    return not beside or any(COUPLED.get(other.kind) is LIBRARY[beside] for other in chosen)


def _gear_could(extra: Extra, trial: _Trial) -> bool:
    """Whether a gear's loss is clear, and no larger than one has."""
    (place,) = range(trial.layout.count)[trial.layout.extra(extra)]
    loss = trial.like.theta[place]
    error = np.sqrt(trial.like.covariance[place, place])
    return bool(SURE * error < loss < MOST_LOSS)


def _gains(extra: Extra, trial: _Trial, now: _Trial) -> bool:
    """Whether the joints together leave less on unseen stretches, and those that it touches clearly
    less for the numbers that it costs."""
    moved = now.left > NOTHING  # a joint that rests leaves nothing, and gains nothing
    less = np.where(
        moved, -np.log(np.maximum(trial.left, NOTHING) / np.maximum(now.left, NOTHING)), 0.0
    )
    return bool(less.sum() > 0.0 and less[list(extra.touches)].mean() > LEAST_GAIN * extra.size)


def _pinned(base: Fit, prior: Prior) -> Prior:
    """The prior with friction held at zero that would go below without bounds."""
    layout = base.layout
    problem = FitProblem(base.sums, base.prior, base.correlation, layout.positive())
    below = problem.positive & (problem.unbounded_minimum(base.numbers) < 0.0)
    below[layout.drive("rotor")] = False
    drives = prior.drives.copy()
    drives[np.flatnonzero(below) - layout.inertial] *= PINNED
    return replace(prior, drives=drives)
