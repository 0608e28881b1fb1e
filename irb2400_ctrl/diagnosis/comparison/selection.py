"""Forward selection of explanations with a family-wise criterion, then exchange and pruning."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Mask
from irb2400_ctrl.diagnosis.comparison.acceptance import Acceptance
from irb2400_ctrl.diagnosis.comparison.at_load_changes import AtLoadChanges
from irb2400_ctrl.diagnosis.comparison.at_reversals import AtReversals
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative, StepComparison
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria, Threshold
from irb2400_ctrl.diagnosis.comparison.ground import Ground, Name, named
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.comparison.step import Step, apart, of_the_whole_arm, without_its_other
from irb2400_ctrl.diagnosis.comparison.wider_numbers import rather_wider
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate, simple
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque

UNSETTLED = (
    "the search for names ended before it settled: they come and go with each other, as where "
    "something acts on the whole arm that no name fits; take what is said for a suspicion"
)
NAMELESS = (
    "joint {joint}: what is left there without a name weighs more than twice as much as a name "
    "that was found; that name was taken back"
)
DOUBTS = 2
"""refused flexible laws of a joint that its effects are held against"""


class Selection:
    """Explains the filtered residual of one log, given its uncertain base."""

    def __init__(
        self,
        scan: Scan,
        fitter: Fitter,
        criteria: Criteria | None = None,
        *,
        change: bool = False,
    ) -> None:
        """`change`: whether the robot is this very arm as it was on another day."""
        self.change = change
        self.scan = scan
        self.fitter = fitter
        self.criteria = Criteria() if criteria is None else criteria
        self.refused: set[Name] = set()
        self.seldom: dict[int, str] = {}
        """flexible laws by joint that unseen rows did not bear out"""
        self.looks = 0
        self.nameless: int | None = None
        """joint (from 1) with much that no name says, for which lesser names were taken back"""
        self.acceptance = Acceptance(fitter, self.criteria)
        motion = scan.motion
        predicted = fitter.predicted()
        robot = fitter.robot
        stated = [effect_torque(fitter.bases, e, motion) for e in robot.effects]
        self.threshold = Threshold(self.criteria, motion, [predicted, *stated], robot)
        left = motion.tau - predicted
        self.turns = AtReversals(motion, left)
        self.load_changes = AtLoadChanges(motion, left, scan.load, fitter.bases.model)

    def run(self) -> tuple[list[Step], Fit]:
        """The accepted explanations, in the order they were found, and their common fit."""
        steps: list[Step] = []
        while True:
            found, fit = self._searched(steps)
            steps, fit = self._borne_out(found, fit)
            kept = {named(s.candidate) for s in steps}
            dropped = {named(s.candidate) for s in found} - kept - self.refused
            if not dropped:
                break
            # what it had stood in for is looked for once more, what was chosen beside it again
            self.refused |= dropped
            gone = [s.candidate for s in found if named(s.candidate) in dropped]
            steps = self._exchanged(steps, gone)
        steps, fit = self._weighty(steps, fit)
        told = zip(steps, self.acceptance.gains(steps, fit), strict=True)
        steps = [replace(step, validation_gain=gain) for step, gain in told]
        return steps, self.fitter.as_stated(fit)

    def _searched(self, steps: list[Step]) -> tuple[list[Step], Fit]:
        """Explanations added to those there are, while they count."""
        ground = self._beside([s.candidate for s in steps])
        tried: list[Counter[Name]] = []  # a joint may have two ripples
        while self._goes_on(steps):
            step = self.next_step(ground)
            beside = ground.comparison
            wider = rather_wider(self.scan, self.fitter, beside, step, self.criteria)
            if wider is not None:
                # beside numbers that may be further off everything is judged anew
                self.fitter.widen(wider)
                steps = []
                tried = []
                self.refused.clear()
                ground = self._beside([s.candidate for s in steps])
                continue
            if step is None:
                lone = without_its_other(steps)
                if lone is None:
                    break
                self.refused.add(named(steps.pop(lone).candidate))
                ground = self._beside([s.candidate for s in steps])
                continue
            further, there = self._clear([*steps, step], len(steps))
            if not self.acceptance.bears_out(further, there, len(steps)):
                # the next best is tried instead
                self.refused.add(named(step.candidate))
                if not step.candidate.known and step.candidate.joint:
                    self.seldom[step.candidate.joint] = step.candidate.name
                continue
            steps = further if len(further) == 1 else self._exchanged(further)
            ground = self._beside([s.candidate for s in steps])
            names = Counter(named(s.candidate) for s in steps)
            if names in tried:
                break  # one explanation pushes another out and is pushed out by it again
            tried.append(names)
        return steps, self.fitter.fit([s.candidate for s in steps])

    def _beside(self, chosen: Sequence[Candidate], on: Mask | None = None) -> Ground:
        """The ground beside what is chosen, on some joints (n,) or all."""
        fit = self.fitter.fit(chosen)
        comparison = StepComparison(self.scan, self.fitter.noise, fit.y, fit.Z, chosen)
        load_changes = self.load_changes
        return Ground(comparison, self.threshold, self.turns, load_changes, on, change=self.change)

    def _goes_on(self, steps: Sequence[Step]) -> bool:
        """Whether a further explanation may be looked for."""
        few = len(steps) < self.criteria.most and self._refused() < self.criteria.most_refused
        whole = of_the_whole_arm(steps, self.scan.motion.n)
        return few and not whole and not self.unsettled

    @property
    def unsettled(self) -> bool:
        """Whether it has looked as often as it may."""
        return self.looks >= self.criteria.most_looks

    @property
    def remarks(self) -> tuple[str, ...]:
        """Why what it says is weaker than usual, in words."""
        said = [UNSETTLED] if self.unsettled else []
        said += [NAMELESS.format(joint=self.nameless)] if self.nameless else []
        return tuple(said)

    def _refused(self) -> int:
        """Number of names that were refused; the flexible laws of a joint, of which there is one,
        do not keep a name from its turn."""
        return sum(bool(name) for _, _, name in self.refused)

    def _borne_out(self, steps: list[Step], fit: Fit) -> tuple[list[Step], Fit]:
        """What the common fit of all still bears out."""
        place = len(steps) - 1
        while place >= 0:
            steps, fit = self._clear(steps, place)
            if not self.acceptance.bears_out(steps, fit, place, all_found=True):
                steps = steps[:place] + steps[place + 1 :]
                fit = self.fitter.fit([s.candidate for s in steps])
            place -= 1
        return steps, fit

    def _weighty(self, steps: list[Step], fit: Fit) -> tuple[list[Step], Fit]:
        """Explanations, but for names that say less than half of what no name says on a joint
        without a larger one: where so much is not understood a little shows nothing."""
        if not steps:
            return steps, fit
        ground = self._beside([s.candidate for s in steps])
        comparison = ground.comparison
        most = 0.0
        where: int | None = None
        # what unseen rows did not bear out is there all the same
        for rest in ground.alternatives():
            left = comparison.gain(rest)
            joint = rest.candidate.joint
            beside = [s.gain for s in steps if s.candidate.joint == joint]
            if left > max(self.threshold.least_gain(comparison, rest), *beside, 0.0):
                left -= self.threshold.left_by(comparison, joint)
                if left > most:
                    most = left
                    # what is too small for its name has one
                    small = (
                        rest.candidate.known and not self.threshold.matters(comparison, rest).any()
                    )
                    where = None if small else self.threshold.most_on(rest.candidate)
        kept = [
            s
            for s in steps
            if not s.candidate.known or (1.0 + self.criteria.two_at_once) * s.gain > most
        ]
        if len(kept) < len(steps):
            fit = self.fitter.fit([s.candidate for s in kept])
            told = {s.candidate.joint for s in kept if not s.candidate.known}
            self.nameless = None if where in told else where
        return kept, fit

    def _clear(self, steps: list[Step], place: int) -> tuple[list[Step], Fit]:
        """The steps and their common fit, one of them with those effects alone that stand clear of
        nothing, where any do."""
        while True:
            fit = self.fitter.fit([s.candidate for s in steps])
            clear = self.acceptance.clear(steps, fit, place)
            if all(clear) or not any(clear):
                return steps, fit
            steps = [*steps[:place], steps[place].only(clear), *steps[place + 1 :]]

    def next_step(
        self, ground: Ground, alone: bool = False, among: Sequence[Alternative] = ()
    ) -> Step | None:
        """The best further explanation if it counts.

        Args:
            ground: beside what it is to be.
            alone: no two effects in the place of a non-parametric law.
            among: these alone; default all.
        """
        self.looks += not alone and not among
        comparison = ground.comparison
        every = [*among] or ground.alternatives(self.refused)
        while True:
            best, alternatives = self._best(ground, every, alone)
            if best is None:
                return None
            if alone or not self._doubted(ground, best):
                break
            # what is there is none of the effects of this joint, or of the whole arm
            joint = best.candidate.joint
            every = [a for a in every if not (a.candidate.known and a.candidate.joint == joint)]
        counts = best in alternatives
        alternatives += [] if counts else [best]
        if comparison.gain(best) < self.threshold.least_gain(comparison, best):
            return None
        polished = comparison.polished(best)
        alternatives[alternatives.index(best)] = polished
        gain = comparison.gain(best)
        alternatives += ground.passing(polished.candidate)
        return Step(polished.candidate, gain, tuple(alternatives), one_of_two=not counts)

    def _best(
        self, ground: Ground, every: Sequence[Alternative], alone: bool
    ) -> tuple[Alternative | None, list[Alternative]]:
        """The best of all alternatives, and those that count; `alone` as of `next_step`."""
        alternatives = [
            alternative
            for alternative in every
            if ground.accepts(alternative)
            and not self.threshold.said_by_less(ground.comparison, alternative, every)
            and not ground.lags_on_a_spring(alternative, every)
        ]
        if not alternatives:
            return None, []
        best = self.threshold.best(ground.comparison, alternatives)
        if not best.candidate.known and not alone:
            best = self._first_of_two(ground, best, every)
        return best, alternatives

    def _doubted(self, ground: Ground, best: Alternative) -> bool:
        """Whether non-parametric laws of the joint of an effect, one on each joint of one of the
        whole arm, gain so much more that no second effect makes up for it, laws that unseen rows do
        not bear out: what is there is not this effect all the same."""
        if not best.candidate.known:
            return False
        joint = best.candidate.joint
        joints = {j for kind, j, _ in self.refused if kind == "unexplained"}
        comparison = ground.comparison
        gained = 0.0
        for place in joints if joint is None else joints & {joint}:
            laws = [c for c in ground.ranked if not c.known and c.joint == place][:DOUBTS]
            gains = [comparison.gain(comparison.compared(law)) for law in laws]
            gained += max(gains, default=0.0)
        return gained > (1.0 + self.criteria.two_at_once) * comparison.gain(best)

    def _first_of_two(
        self, ground: Ground, non_parametric: Alternative, alternatives: Sequence[Alternative]
    ) -> Alternative:
        """The better of two effects that together explain a joint at least as well as the
        non-parametric law, else that law.

        A flexible function takes in both at once, so that either of them alone is beaten by it.
        Large families (a ripple of any order) are flexible functions themselves, and of two of
        which the better says less than half of it either may be anything: these must be better as
        clearly as it would have to be.
        """
        comparison = ground.comparison
        joint = non_parametric.candidate.joint
        gained = comparison.gain(non_parametric)
        own = np.arange(self.scan.motion.n) + 1 == joint

        def of_joint(candidate: Candidate) -> bool:
            """What begins now and then follows whatever grows with the time."""
            return candidate.known and candidate.joint == joint and not candidate.begins

        known = [r for r in alternatives if of_joint(r.candidate)]
        plain_ones = [r for r in known if simple(r.candidate)]
        for first in {id(r): r for r in (*plain_ones[:1], *known[:1])}.values():
            gain = comparison.gain(first)
            if gain < self.criteria.gain:
                continue
            both = self._beside([*comparison.chosen, first.candidate], own)
            second = self.next_step(both, alone=True)
            if second is None or not of_joint(second.candidate):
                continue
            near = gained <= (1.0 + self.criteria.two_at_once) * gain
            plain = near and simple(first.candidate) and simple(second.candidate)
            if gain + second.gain > gained + (0.0 if plain else self.criteria.unknown):
                return first
        return non_parametric

    def _exchanged(self, steps: list[Step], gone: Sequence[Candidate] = ()) -> list[Step]:
        """Each explanation held again, given the others, against what acts on a joint of it, where
        the last has come, or some have `gone`; a flexible law also beside a name of other joints,
        which the base may have been bent to hide. One that no longer counts falls out."""
        kept = list(steps)
        n = self.scan.motion.n
        newest = None if gone else steps[-1].candidate
        changed = np.logical_or.reduce([c.acts_on(n) for c in gone or [steps[-1].candidate]])
        for place in reversed(range(len(steps) - (newest is not None))):
            earlier = kept[place].candidate
            there = earlier.acts_on(n)
            name_beside = newest is not None and newest.known and not earlier.known
            if not name_beside and not (changed & there).any():
                continue
            if self.unsettled:
                break
            others = [s.candidate for k, s in enumerate(kept) if k != place]
            step = self._again(earlier, self._beside(others, there))
            if step is None and all(o.known for o in others):
                kept.pop(place)
                changed |= there
            elif step is not None and (step.candidate.known or not earlier.known):
                # a flexible law never takes the place of a name
                kept[place] = step
                if named(step.candidate) != named(earlier):
                    changed |= there | step.candidate.acts_on(n)
        return apart(kept)

    def _again(self, earlier: Candidate, ground: Ground) -> Step | None:
        """The step in the place of an explanation: the same, where nothing comes near it."""
        name = named(earlier)
        ahead = ground.far_ahead(name)
        step = self.next_step(ground, among=ahead) if ahead else None
        return step if step and named(step.candidate) == name else self.next_step(ground)
