"""Forward selection of explanations with a family-wise criterion, then exchange and pruning."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.diagnosis.evidence import Problem, departure_shares
from irb2400_ctrl.diagnosis.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.motion import STICKING_SPEED, Motion
from irb2400_ctrl.diagnosis.noise import Noise, autoregressive, white
from irb2400_ctrl.diagnosis.predict import predicted_torque
from irb2400_ctrl.diagnosis.scan import Candidate, Scan
from irb2400_ctrl.diagnosis.step import Left, Rival, Step
from irb2400_ctrl.diagnosis.windows import acting, windowed
from irb2400_ctrl.measurement.uniform import widened

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

TRIED_IN_PART = 6
"""how many of the best effects are also tried as acting part of the time"""
SMALL_FAMILY = 20
"""members of a family that still is one law"""
REVERSAL_TIME = 0.16
"""[s] rows nearer than this to a reversal have a variance of their own"""


@dataclass(frozen=True)
class Criteria:
    """When an explanation counts.

    Args:
        gain: log evidence of an effect over the model without it [nats], family-wise; generic_gain: of a generic law.
        energy: its energy over what the base alone leaves on that joint.
        torque: its rms torque over the joint's; torque_beside_law: the same where its law alone gains less than
            `by_law` of what it gains with departures.
        leftover: times what the law of an effect found before may leave (`Effect.leftover`), which counts no more.
        largest: its rms torque over the joint's, above which it only cancels another one.
        two_at_once: how much more a generic law may gain than the best effect, for two effects to be tried instead.
        unknown: how much a generic law must beat the best effect by [nats], and as share of that effect's gain.
    """

    gain: float = 22.0
    generic_gain: float = 25.0
    energy: float = 0.05
    torque: float = 0.003
    torque_beside_law: float = 0.02
    by_law: float = 0.25
    leftover: float = 1.0
    largest: float = 1.5
    two_at_once: float = 1.0
    unknown: float = 10.0
    unknown_share: float = 0.02
    shortlist: int = 10
    most: int = 8


class Selection:
    """Explains the filtered residual of one log, given its uncertain base."""

    def __init__(self, scan: Scan, fitter: Fitter, criteria: Criteria | None = None) -> None:
        self.scan, self.fitter = scan, fitter
        self.criteria = Criteria() if criteria is None else criteria
        self.motion: Motion = scan.motion
        self.reversal = fitter.reversal
        self.rms_torque = np.sqrt(np.mean(self.motion.filtered(self.motion.tau) ** 2, axis=0))
        self.rms_predicted = np.sqrt(
            np.mean(self.motion.filtered(predicted_torque(fitter.robot, self.motion)) ** 2, axis=0)
        )
        self.y = np.zeros((0, 0))

    def run(self) -> tuple[list[Step], Fit]:
        """The accepted explanations, in the order they were found, and their common fit."""
        steps: list[Step] = []
        fit = self.fitter.fit([])
        tried: set[frozenset[tuple[str, int | None, str]]] = set()
        while len(steps) < self.criteria.most:
            step = self.next_step([s.candidate for s in steps], fit)
            if step is None:
                break
            steps.append(step)
            if len(steps) > 1:
                steps = self._exchanged(steps)
            fit = self.fitter.fit([s.candidate for s in steps])
            names = frozenset((s.candidate.kind, s.candidate.joint, s.candidate.name) for s in steps)
            if names in tried:
                break  # one explanation pushes another out and is pushed out by it again
            tried.add(names)
        return steps, fit

    def next_step(self, chosen: Sequence[Candidate], fit: Fit, alone: bool = False) -> Step | None:
        """The best further explanation if it counts; `alone`: no two effects in the place of a generic law."""
        self.y, Z = fit.y, fit.Z
        base, before = self._base(Z)
        every = self.rivals(Z, chosen)
        rivals = [r for r in every if self._practical(r, r.evidence - base, before, chosen, Z)]
        if not rivals:
            return None
        best = self._choice(rivals, base)
        if not best.candidate.known and not alone:
            best = self._first_of_two(best, every, base, chosen)
            rivals += [] if best in rivals else [best]
            self.y = fit.y
        gain = best.evidence - base
        if gain < (self.criteria.gain if best.candidate.known else self.criteria.generic_gain):
            return None
        polished = self._polished(best, Z)
        rivals[rivals.index(best)] = polished
        return Step(polished.candidate, gain, tuple(rivals))

    def _first_of_two(self, generic: Rival, rivals: list[Rival], base: float, chosen: Sequence[Candidate]) -> Rival:
        """The better of two effects that together explain a joint at least as well as the generic law, else that law.

        A flexible function takes in both at once, so that either of them alone is beaten by it. Large families (a
        ripple of any order) are flexible functions themselves.
        """
        joint, gained = generic.candidate.joint, generic.evidence - base

        def simple(candidate: Candidate) -> bool:
            return candidate.known and candidate.joint == joint and candidate.penalty < np.log(SMALL_FAMILY)

        first = next((r for r in rivals if simple(r.candidate)), None)
        if first is None or gained > (1.0 + self.criteria.two_at_once) * (first.evidence - base):
            return generic
        both = [*chosen, first.candidate]
        second = self.next_step(both, self.fitter.fit(both), alone=True)
        if second is None or not simple(second.candidate):
            return generic
        return first if first.evidence - base + second.gain > gained else generic

    def rivals(self, Z: Array, chosen: Sequence[Candidate] = ()) -> list[Rival]:
        """The most promising candidates, each judged under its own noise, best first."""
        problem = self._problem(Z)
        ranked = self.scan.rank(problem, chosen)
        short = [self.scan.between(problem, c) for c in shortlist(ranked, self.criteria.shortlist)]
        short += self._in_part(problem, [c for c in ranked if c.known])
        rivals = [self._judged(candidate, Z) for candidate in short]
        return sorted(rivals, key=lambda r: -r.evidence)

    def _in_part(self, problem: Problem, ranked: Sequence[Candidate]) -> list[Candidate]:
        """The best effects acting part of the time, and in the same times whatever else could act on that joint."""
        found = [part for c in ranked[:TRIED_IN_PART] if (part := windowed(self.scan, problem, c)) is not None]
        if not found:
            return []
        best = max(found, key=lambda part: part.score.gain)
        tried = {(part.kind, part.joint) for part in found}
        others = [c for c in ranked if (c.kind, c.joint) not in tried and len(c.effects) == 1]
        same = [
            acting(self.scan, problem, c, best.effects[0].windows_s) for c in others if c.joint in (best.joint, None)
        ]
        return found + sorted(same, key=lambda part: -part.score.gain)[:TRIED_IN_PART]

    def _choice(self, rivals: list[Rival], base: float) -> Rival:
        """The best rival; a generic law only where it clearly beats the library."""
        best = rivals[0]
        known = next((r for r in rivals if r.candidate.known), None)
        if best.candidate.known or known is None:
            return best
        c = self.criteria
        lead = best.evidence - known.evidence
        return best if lead > c.unknown + c.unknown_share * max(known.evidence - base, 0.0) else known

    def _judged(self, candidate: Candidate, Z: Array) -> Rival:
        problem = self._problem(Z)
        for _ in range(2):
            residual = self.y - self._explained(problem, Z, candidate)
            problem = Problem(self.y, Z, self._noise(residual))
            candidate = self._rescored(candidate, problem)
        return Rival(candidate, problem.log_evidence + candidate.score.gain, self._by_law(candidate, problem))

    def _by_law(self, candidate: Candidate, problem: Problem) -> float:
        """Gain of a candidate by its law alone, without the departures from it."""
        if candidate.departures is None or any(e.states for e in candidate.effects):
            return candidate.score.gain
        return problem.score(candidate.law, scales=self.scan.scales(candidate)).gain - candidate.penalty

    def _polished(self, rival: Rival, Z: Array) -> Rival:
        """The rival with its nonlinear parameters searched, where the fit can not do it."""
        candidate = rival.candidate
        if not candidate.known or not any(e.states for e in candidate.effects):
            return rival
        problem = self._problem(Z)
        problem = Problem(self.y, Z, self._noise(self.y - self._explained(problem, Z, candidate)))
        return replace(rival, candidate=self.scan.polished(problem, candidate))

    def _rescored(self, candidate: Candidate, problem: Problem) -> Candidate:
        scales = self.scan.scales(candidate)
        shares = None
        if candidate.known and candidate.departures is not None:
            shares = departure_shares(candidate.kind, candidate.departures.values.shape[2])
        score = problem.score(candidate.law, candidate.departures, scales, shares)
        return replace(candidate, score=replace(score, gain=score.gain - candidate.penalty))

    def _explained(self, problem: Problem, Z: Array, candidate: Candidate) -> Array:
        """Torque of the candidate and the base together, fitted under the problem's noise."""
        tau = candidate.torque(self.motion.n)
        return np.asarray(tau + Z @ problem.base_beside(tau))

    def _problem(self, Z: Array) -> Problem:
        """White noise of the level that the base leaves."""
        rows = self.motion.row_known

        def level(residual: Array) -> list[Noise]:
            return [white(residual[:, j], rows[:, j], self.reversal[:, j]) for j in range(self.motion.n)]

        return Problem(self.y, Z, level(self.y - Z @ Problem(self.y, Z, level(self.y)).z))

    def _base(self, Z: Array) -> tuple[float, Left]:
        """Log evidence without a further explanation, and what it leaves."""
        problem = self._problem(Z)
        for _ in range(2):
            residual = self.y - Z @ problem.z
            problem = Problem(self.y, Z, self._noise(residual))
        return problem.log_evidence, Left(self._energy(self.y - Z @ problem.z), problem.noise)

    def _noise(self, residual: Array) -> list[Noise]:
        rows = self.motion.row_known
        return [autoregressive(residual[:, j], rows[:, j], self.reversal[:, j]) for j in range(self.motion.n)]

    def _energy(self, residual: Array) -> Array:
        calm = self.motion.row_known & ~self.reversal
        return np.array(
            [np.mean(residual[calm[:, j], j] ** 2) if calm[:, j].any() else 0.0 for j in range(self.motion.n)]
        )

    def _practical(self, rival: Rival, gain: float, left: Left, chosen: Sequence[Candidate], Z: Array) -> bool:
        """Large enough to matter, on at least one joint it acts on.

        Beside an effect already found on a joint the leftovers of a law of slightly another shape are no effect of
        their own: it must take a good part off the residual there, or, where the base had been bent to hide it, gain
        a good part of the evidence.
        """
        c, n, candidate = self.criteria, self.motion.n, rival.candidate
        size = np.sqrt(np.mean(candidate.torque(n) ** 2, axis=0))
        if (size > c.largest * np.maximum(self.rms_torque, self.rms_predicted)).any():
            return False  # a torque that something else must cancel again
        # by departures from its law alone: the base takes the law in, and only a good size still speaks for the name
        least = c.torque if rival.by_law > c.by_law * candidate.score.gain else c.torque_beside_law
        matters = (size > np.sqrt(c.energy * left.energy)) & (size > least * self.rms_torque)
        if chosen and matters.any():
            problem = self._problem(Z)
            after = self._energy(self.y - self._explained(problem, Z, candidate))
            added = np.sqrt(np.maximum(left.energy - after, 0.0))
            for earlier in chosen:
                torque, share = earlier.torque(n), c.leftover * earlier.leftover
                more = added > share * np.sqrt(np.mean(torque**2, axis=0))
                # a flexible law has taken in whatever the base could hide there
                if candidate.known and earlier.known:
                    known = left.by_joint(earlier.score.gain, torque) if earlier.joint is None else earlier.score.gain
                    more |= gain > share**2 * known
                matters &= more
            if not candidate.known:
                matters &= added > np.sqrt(c.energy * left.energy)
        return bool(matters.any())

    def _exchanged(self, steps: list[Step]) -> list[Step]:
        """Each explanation judged again given the others; one that no longer counts falls out."""
        kept = list(steps)
        for place in reversed(range(len(steps) - 1)):
            others = [s.candidate for k, s in enumerate(kept) if k != place]
            step = self.next_step(others, self.fitter.fit(others))
            if step is None and all(o.known for o in others):
                kept.pop(place)
            elif step is not None and (step.candidate.known or not kept[place].candidate.known):
                # a flexible law never takes the place of a name
                kept[place] = step
        return kept


def shortlist(ranked: Sequence[Candidate], count: int) -> list[Candidate]:
    """The best `count` candidates, among them at least a third of the library and a few generic ones."""
    known = [c for c in ranked if c.known][: max(count * 2 // 3, 1)]
    generic = [c for c in ranked if not c.known][: max(count - len(known), count // 3)]
    return known + generic


def reversal_rows(motion: Motion) -> Mask:
    """Rows near a change of direction or a near stop, shape (rows, n)."""
    turning = np.abs(motion.qd) < STICKING_SPEED
    for j in range(motion.n):
        turning[np.flatnonzero(np.diff(np.sign(motion.qd[:, j])) != 0), j] = True
        turning[:, j] = widened(turning[:, j], round(REVERSAL_TIME / motion.step))
    return motion.at_rows(turning.astype(float)) > 0.5
