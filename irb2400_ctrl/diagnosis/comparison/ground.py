"""The candidates beside what is chosen so far."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import cache, cached_property, partial
from typing import TypeVar

from irb2400_ctrl.arrays import Mask
from irb2400_ctrl.diagnosis.comparison.at_load_changes import AtLoadChanges
from irb2400_ctrl.diagnosis.comparison.at_reversals import AtReversals
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative, StepComparison
from irb2400_ctrl.diagnosis.comparison.criteria import Threshold
from irb2400_ctrl.diagnosis.comparison.onset import JOINTS_OF, Windowing
from irb2400_ctrl.diagnosis.comparison.passing import slow_ripple, springs
from irb2400_ctrl.diagnosis.estimation.candidate import EVERY_JOINT, Candidate
from irb2400_ctrl.effects.gear_ripple import GearRipple

Name = tuple[str, int | None, str]
One = TypeVar("One")
Found = TypeVar("Found")


class Ground:
    """What is chosen so far, and the candidates beside it: each judged once, however many of them
    the search refuses before it goes on."""

    def __init__(
        self,
        comparison: StepComparison,
        threshold: Threshold,
        turns: AtReversals,
        load_changes: AtLoadChanges,
        on: Mask | None = None,
        *,
        change: bool = False,
    ) -> None:
        """Nothing is judged yet.

        Args:
            comparison: beside what is chosen.
            threshold: says what counts.
            turns: what the turns of the joints say of an effect.
            load_changes: what the changes of their load say.
            on: joints of which a candidate acts on one at least; default all, shape (n,).
            change: whether the robot is this very arm as it was on another day.
        """
        self.on = on
        self.comparison = comparison
        self.threshold = threshold
        self.load_changes = load_changes

        def told(candidate: Candidate) -> Alternative:
            """A candidate under its own noise, with what turns and changes of load say of it."""
            alone = turns.told(comparison.compared(candidate))
            found = load_changes.told(alone, comparison.chosen)
            against = sum(e.prior.steady for e in candidate.effects) if change else 0.0
            return replace(found, evidence=found.evidence - against) if against else found

        # none of these holds the ground itself, which would stay in memory with all it has judged
        self.accepts = _once(partial(threshold.accepts, comparison))
        self._told = _once(told)
        self._between = _once(partial(comparison.scan.between, comparison.start))
        self._part_of_the_time = cache(Windowing(comparison.scan, comparison.start).candidates)

    @cached_property
    def ranked(self) -> list[Candidate]:
        """All plausible candidates, best first."""
        return self.comparison.scan.rank(self.comparison.start, self.comparison.chosen, self.on)

    def alternatives(self, refused: Collection[Name] = ()) -> list[Alternative]:
        """The most promising candidates, each judged under its own noise, best first; without those
        of `refused` names."""
        criteria = self.threshold.criteria
        ranked = [c for c in self.ranked if not _is_refused(c, refused)]
        listed = shortlist(ranked, criteria.shortlist, criteria.lowest)
        chosen = self.comparison.chosen
        rattling = next((c for c in ranked if self.load_changes.rattles(c, chosen)), None)
        if rattling is not None and all(c is not rattling for c in listed):
            listed.append(rattling)
        short = [self._between(c) for c in listed]
        joints = frozenset(c.joint for c in [c for c in ranked if c.known][:JOINTS_OF])
        short += [c for c in self._part_of_the_time(joints) if not _is_refused(c, refused)]
        return sorted(map(self._told, short), key=lambda one: -one.evidence)

    def far_ahead(self, name: Name) -> list[Alternative]:
        """The best candidate and the next, where it has this name and gains so much more than any
        other that no look at all of them is needed; else none."""
        known = [c for c in self.ranked if c.known]
        others = [c for c in known if named(c) != name][:1]
        ahead = 1.0 + self.threshold.criteria.two_at_once
        # where the best has another name, that is among the others
        if any(ahead * c.score.gain > known[0].score.gain for c in others):
            return []
        return [self._told(self._between(c)) for c in (*known[:1], *others)]

    def passing(self, law: Candidate) -> list[Alternative]:
        """What a law passes for, though it may not be plausible by itself.

        A ripple of fewer periods a turn than one is named for, beside a law of the angle: over a
        short travel they look alike. A soft transmission beside play: one that stiffens, or swings
        faster than records show, is none, and leaves torques like those of play.
        """
        scan = self.comparison.scan
        start = self.comparison.start
        if law.joint is None:
            return []
        if law.kind in GearRipple.ambiguity.passing:
            return [self._told(slow_ripple(scan, start, law.joint))]
        if law.rattles:
            told = [self._told(spring) for spring in springs(scan, start, law.joint)]
            return sorted(told, key=self.comparison.gain)[-1:]
        return []

    def lags_on_a_spring(self, late: Alternative, every: Sequence[Alternative]) -> bool:
        """Whether an angle that seems late is a link behind a soft transmission, or one with play:
        one is there, or counts, beside the lateness too, which has no swing.
        """
        if not any(e.angle_error[1] for e in late.candidate.effects):
            return False

        def behind(one: Candidate) -> bool:
            return one.joint == late.candidate.joint and bool(one.devices)

        comparison = self.comparison
        if any(map(behind, comparison.chosen)):
            return True
        least = self.threshold.criteria.gain
        rivals = [a for a in every if behind(a.candidate) and comparison.gain(a) > least]
        if not rivals:
            return False
        lateness = late.candidate.torque(comparison.n)[:, :, None]
        return any(comparison.gain_beside(a.candidate, lateness) > least for a in rivals)


def named(candidate: Candidate) -> Name:
    """What a candidate is called; flexible laws of one joint are one."""
    return candidate.kind, candidate.joint, candidate.name if candidate.known else ""


def _is_refused(candidate: Candidate, refused: Collection[Name]) -> bool:
    """Whether a candidate is of `refused` names: where one number for all joints was not borne out
    (a liquid at the tool looks like a delay), the same number of one joint is no more."""
    kind = candidate.kind
    for_all = any(
        k == kind and joint is None and EVERY_JOINT not in name for k, joint, name in refused
    )
    return named(candidate) in refused or (candidate.known and for_all)


def shortlist(ranked: Sequence[Candidate], count: int, least: float) -> list[Candidate]:
    """The best `count` candidates, among them at least a third of the library and a few
    non-parametric ones; then the best of each joint that has none among them: the many rivals of
    one joint hide no other's. A coupling of two is neither's own: its gain may be the other's.

    Args:
        ranked: all, best first; count: to be named so.
        least: that the best of a further joint gains [nats].
    """
    known = [c for c in ranked if c.known][: max(count * 2 // 3, 1)]
    non_parametric = [c for c in ranked if not c.known][: max(count - len(known), count // 3)]
    hidden: dict[tuple[int, ...], Candidate] = {}
    for candidate in ranked:
        if candidate.known and candidate.score.gain > least:
            hidden.setdefault(candidate.law.joints, candidate)
    seen = {c.law.joints for c in known}
    return [*known, *(c for joints, c in hidden.items() if joints not in seen), *non_parametric]


def _once(function: Callable[[One], Found]) -> Callable[[One], Found]:
    """A function that is worked out once for each object."""
    found: dict[int, tuple[One, Found]] = {}

    def kept(one: One) -> Found:
        if id(one) not in found:
            found[id(one)] = one, function(one)  # held, so that no other object gets its id
        return found[id(one)][1]

    return kept
