"""Compares candidates on one log: each under the noise that it leaves itself, against a base that
may bend to hide it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.diagnosis.comparison.polish import polished
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Problem, discrepancy_shares
from irb2400_ctrl.diagnosis.preparation.noise import NoiseModel
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque

RELIEVED = 0.5
"""of z^T z: the bend of the base that a torque leaves it which it had hidden (0.13 to 0.40 beside
grease that it had, 0.58 and more beside all others of the same steps)"""

MOST_ROUNDS = 8
"""of fitting and of estimating the noise that the fit leaves; two do but where much is left"""
SETTLED = 10.0
"""[nats] gained by a further round, below which it is the last"""
One = TypeVar("One")


@dataclass(frozen=True)
class Alternative:
    """A candidate with its own noise model.

    Args:
        evidence: log evidence under the noise that the candidate leaves [nats].
        by_law: what it gains without discrepancy from its law [nats].
        rattles: whether the neighbours feel it, beside what its torque says.
    """

    candidate: Candidate
    evidence: float
    by_law: float
    rattles: bool = False

    def by_its_law(self, share: float) -> bool:
        """Whether more than this share of what it gains is its law's, the rest what it departs from
        that."""
        return self.by_law > share * self.candidate.score.gain


def settled(first: One, anew: Callable[[One], One], evidence: Callable[[One], float]) -> One:
    """What rounds of fitting, and of estimating the noise that the fit leaves, come to.

    The noise of a torque that much is left of is believed to be white; taken for coloured it shows
    more of what is left, and the fit moves.

    Args:
        first: before the first round; anew: one after another; evidence: of it [nats].
    """
    best = anew(first)
    for _ in range(MOST_ROUNDS - 1):
        other = anew(best)
        gained = evidence(other) - evidence(best)
        best = other if gained > 0.0 else best
        if gained < SETTLED:
            break
    return best


def _evidence(problem: Problem, candidate: Candidate) -> float:
    return problem.log_evidence + candidate.score.gain


class StepComparison:
    """What one step is judged on: filtered torques y (rows, n) that are left, and the base Z (rows,
    n, k) that may move."""

    def __init__(
        self, scan: Scan, noise: NoiseModel, y: Array, Z: Array, chosen: Sequence[Candidate] = ()
    ) -> None:
        """`noise`: what passes for it; `chosen`: explanations that y is what is left of."""
        self.scan = scan
        self.noise = noise
        self.y = y
        self.Z = Z
        self.chosen = chosen
        self.n = scan.motion.n

    @cached_property
    def start(self) -> Problem:
        """Under white noise of the level that the base leaves: the ground for a first ranking."""
        problem = Problem(self.y, self.Z, self.noise.white(self.y))
        return problem.under(self.noise.white(self.y - self.Z @ problem.z))

    @cached_property
    def base(self) -> Problem:
        """Without a further explanation, under the noise that this leaves."""
        return settled(
            self.start,
            lambda problem: self._under(self.y - self.Z @ problem.z),
            lambda problem: problem.log_evidence,
        )

    @cached_property
    def energy(self) -> Array:
        """Mean square that the base leaves away from reversals, shape (n,) [Nm2]."""
        return self._energy(self.y - self.Z @ self.base.z)

    def known_rms(self, torque: Array) -> Array:
        """Rms of a torque (rows, n) where it is known, shape (n,) [Nm]."""
        known = self.noise.known
        size = np.sum(np.where(known, torque, 0.0) ** 2, axis=0)
        return np.asarray(np.sqrt(size / np.maximum(known.sum(axis=0), 1)))

    def sampled_rms(self, candidate: Candidate) -> Array:
        """Rms of a candidate's effects sample by sample, not filtered, shape (n,) [Nm]."""
        scan = self.scan
        torques = [effect_torque(scan.bases, e, scan.motion) for e in candidate.effects]
        return rms(np.sum(torques, axis=0))

    def compared(self, candidate: Candidate) -> Alternative:
        """The candidate under its own noise."""
        problem, judged = self._under_own_noise(candidate)
        return Alternative(judged, _evidence(problem, judged), self._by_law(judged, problem))

    def _under_own_noise(self, candidate: Candidate) -> tuple[Problem, Candidate]:
        return settled((self.start, candidate), self._judged_anew, lambda one: _evidence(*one))

    def _judged_anew(self, last: tuple[Problem, Candidate]) -> tuple[Problem, Candidate]:
        problem, candidate = last
        problem = self._under(self.y - self._explained(problem, candidate))
        return problem, self._rescored(candidate, problem)

    def gain(self, alternative: Alternative) -> float:
        """Log evidence over the base alone [nats]."""
        return alternative.evidence - self.base.log_evidence

    def polished(self, alternative: Alternative) -> Alternative:
        """The alternative with its nonlinear parameters searched, where the fit can not do it."""
        candidate = alternative.candidate
        if not any(e.states for e in candidate.effects):
            return alternative
        # what is tried is held against the candidate under one noise
        found = polished(self.scan, *self._under_own_noise(candidate))
        return replace(alternative, candidate=found)

    def added(self, candidate: Candidate) -> Array:
        """Rms that a candidate takes off what is left, beside a base that moves with it, shape (n,)
        [Nm]."""
        after = self._energy(self.y - self.explained(candidate))
        return np.sqrt(np.maximum(self.energy - after, 0.0))

    def explained(self, candidate: Candidate) -> Array:
        """Torque of a candidate and a base that moves with it, shape (rows, n) [Nm]."""
        return self._explained(self.start, candidate)

    def share_beyond_base(self, candidate: Candidate) -> float:
        """Share of its torque that no other numbers of the base would give."""
        return self.start.share_beyond_base(candidate.torque(self.n))

    def relieves_base(self, candidate: Candidate) -> bool:
        """Whether the base is bent less than half as much beside a candidate."""
        z = self.base.z
        beside = self.base.base_beside(candidate.torque(self.n))
        return bool(beside @ beside < RELIEVED * (z @ z))

    def elsewhere(self, candidate: Candidate) -> float:
        """Share of what a candidate takes off the whitened squares that it takes off outside its
        best second, over the share of its torque there: in a short record a joint may move in
        hardly more than one second.

        What began within the record has nothing but the record's end to show itself: over 1.
        """
        # under the noise that it leaves: that of the base may hold all of it for a reversal's
        problem = self._under(self.y - self.explained(candidate))
        before = self.y - self.Z @ problem.z
        after = self.y - self._explained(problem, candidate)
        torque = candidate.torque(self.n)
        second = (self.scan.motion.row_time - self.scan.motion.row_time[0]).astype(np.intp)
        taken = np.zeros(second[-1] + 1)
        acting = np.zeros(len(taken))
        for j, one in enumerate(problem.noise):
            change = one.whiten(before[:, j]) ** 2 - one.whiten(after[:, j]) ** 2
            taken += np.bincount(second[one.kept], change, len(taken))
            acting += np.bincount(second[one.kept], one.whiten(torque[:, j]) ** 2, len(taken))
        best = int(np.argmax(taken))
        there = 1.0 if candidate.begins else 1.0 - acting[best] / max(acting.sum(), 1e-12)
        return float((1.0 - taken[best] / max(taken.sum(), 1e-12)) / max(there, 1e-12))

    def leftover(self, earlier: Candidate) -> Array | None:
        """What a law of an effect may leave on its joint, being simpler than the real thing:
        columns (rows, n, k) with unit priors, together as large as that share of its torque; None
        where nothing is known of it."""
        names = earlier.effects[0].prior.leftover if len(earlier.effects) == 1 else ()
        if not names or earlier.joint is None or earlier.begins:
            return None
        place = earlier.joint - 1
        laws = [law.columns for law in self.scan.non_parametric[place] if law.name in names]
        if not laws:
            return None  # of a joint that rests there is no such law
        columns = np.zeros((*self.y.shape, sum(c.shape[1] for c in laws)))
        columns[:, place] = np.hstack(laws)
        whole = np.sqrt(np.mean(columns[:, place] ** 2, axis=0).sum())
        size = np.sqrt(np.mean(earlier.torque(self.n)[:, place] ** 2))
        return np.asarray(columns * (earlier.discrepancy_share * size / max(whole, 1e-12)))

    def with_its_leftover(self, alternative: Alternative) -> float:
        """Log evidence of an alternative and what its law may leave on its joint [nats]; that of
        the alternative alone where nothing is known of it."""
        candidate = alternative.candidate
        columns = self.leftover(candidate)
        if columns is None:
            return alternative.evidence
        Z = np.concatenate([self.Z, columns], axis=2)
        wider = StepComparison(self.scan, self.noise, self.y, Z, self.chosen)
        return wider.compared(candidate).evidence

    def gain_beside(self, candidate: Candidate, columns: Array) -> float:
        """What a candidate gains beside columns (rows, n, k) that move as the base does [nats]."""
        problem = self._under(self.y - self.explained(candidate))
        wider = Problem(self.y, np.concatenate([self.Z, columns], axis=2), problem.noise)
        return self._rescored(candidate, wider).score.gain

    def by_joint(self, gain: float, torque: Array) -> Array:
        """A gain [nats] shared among the joints as its torque (rows, n) stands out there."""
        seen = np.array(
            [np.sum(one.whiten(torque[:, j]) ** 2) for j, one in enumerate(self.base.noise)]
        )
        return np.asarray(max(gain, 0.0) * seen / max(seen.sum(), 1e-12))

    def _under(self, residual: Array) -> Problem:
        """The problem under the noise of a residual."""
        return self.start.under(self.noise.coloured(residual))

    def _explained(self, problem: Problem, candidate: Candidate) -> Array:
        """Torque of the candidate and the base together, fitted under the problem's noise."""
        tau = candidate.torque(self.n)
        return np.asarray(tau + self.Z @ problem.base_beside(tau))

    def _rescored(self, candidate: Candidate, problem: Problem) -> Candidate:
        shares = None
        if candidate.known and candidate.discrepancy is not None:
            shares = discrepancy_shares(candidate.kind, candidate.discrepancy.values.shape[2])
        score = problem.score(candidate.law, candidate.discrepancy, candidate.expected, shares)
        return replace(candidate, score=replace(score, gain=score.gain - candidate.penalty))

    def _by_law(self, candidate: Candidate, problem: Problem) -> float:
        """Gain of a candidate by its law alone, without the discrepancy from it."""
        if candidate.discrepancy is None or any(e.states for e in candidate.effects):
            return candidate.score.gain
        return problem.score(candidate.law, expected=candidate.expected).gain - candidate.penalty

    def _energy(self, residual: Array) -> Array:
        calm = self.noise.known & ~self.noise.reversal
        return np.array(
            [
                np.mean(residual[calm[:, j], j] ** 2) if calm[:, j].any() else 0.0
                for j in range(self.n)
            ]
        )
