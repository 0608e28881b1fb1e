"""When an explanation counts: significant, large enough to matter, and not what an earlier law has
left over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative, StepComparison
from irb2400_ctrl.diagnosis.comparison.own_friction import OwnFriction
from irb2400_ctrl.diagnosis.comparison.passing import of_the_clock
from irb2400_ctrl.diagnosis.comparison.step import of_one_moment
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.ambiguity import BaseTerm
from irb2400_ctrl.effects.base import OPEN_END_S
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

FRICTION: frozenset[BaseTerm] = frozenset(("coulomb", "viscous"))
"""terms of the base that wear and temperature change"""
QUICK = 0.5
"""share of the least torque that is enough of a delay, whose steps where friction turns over are
quicker than what is compared, and of the flaw of a transmission, whose swing is"""


@dataclass(frozen=True)
class Criteria:
    """When an explanation counts.

    Args:
        gain: log evidence of an effect over the model without it [nats], family-wise;
            non_parametric_gain: of a non-parametric law; gain_in_base: of a first effect of which
            other numbers of the robot would give all but the share `in_base`, where no misfit of
            shape or noise can pass for it; gain_stated: the same where the spread of its own
            numbers is known; gain_changed: of the file's number of a joint's friction, which
            another day changes: four of its standard deviations; gain_rattling: of play that the
            neighbours feel, what they say of it among it.
        wider: times as uncertain all numbers of the robot may be, as a rival of the best name.
        energy: its energy over what the base alone leaves on that joint.
        torque: its rms torque over the joint's (of a friction: `OwnFriction`); torque_beside_law:
            the same where its law alone gains less than `by_law` of what it gains with discrepancy.
        largest: its rms torque over the joint's, above which it only cancels another one.
        elsewhere: share of what it explains that lies outside the second in which it explains most,
            over the share of its torque there.
        two_at_once: how much more a non-parametric law may gain than the best effect, for two
            effects to be tried instead, and numbers further off must.
        unknown: how much a non-parametric law must beat the best effect by [nats]; little: how much
            more it must say: rms torque over the effect's, where it beats that by less than the
            share that its law may leave or the base takes the effect in for the most part.
        mostly_base: share of an effect's torque that no other numbers of the robot would give,
            below which unseen rows say nothing about it.
        shortlist: candidates judged in a step; most: explanations of one log; most_refused:
            names that a polished fit does not bear out, most_looks: times that all candidates are
            judged beside what is chosen, before the search ends. Three effects at once take eleven
            at most, a half of the Panda's record nineteen; a liquid at the tool took 52.
    """

    gain: float = 22.0
    non_parametric_gain: float = 25.0
    gain_in_base: float = 11.0
    gain_stated: float = 8.0
    gain_changed: float = 6.0
    gain_rattling: float = 4.0
    in_base: float = 0.01
    wider: tuple[float, ...] = (2.0, 4.0)
    energy: float = 0.05
    torque: float = 0.01
    torque_beside_law: float = 0.02
    by_law: float = 0.25
    largest: float = 1.5
    elsewhere: float = 0.4
    two_at_once: float = 1.0
    unknown: float = 10.0
    little: float = 0.1
    mostly_base: float = 0.05
    shortlist: int = 10
    most: int = 8
    most_refused: int = 4
    most_looks: int = 20

    @property
    def lowest(self) -> float:
        """The least evidence that is enough for any name but play [nats]."""
        return min(self.gain, self.gain_in_base, self.gain_stated, self.gain_changed)


class Threshold:
    """The criteria applied to one log."""

    def __init__(
        self,
        criteria: Criteria,
        motion: PreparedLog,
        predicted: Sequence[Array],
        robot: Robot | None = None,
    ) -> None:
        """`predicted`: torque of the robot as given along the motion, and of each of its effects,
        shape (m, n) [Nm]; `robot`: default one of which no more is known."""
        self.usual: Array | float = 0.0 if robot is None else robot.usually_left
        self.friction = None if robot is None else OwnFriction(robot, motion)
        self.identified = robot is not None and robot.identified is not None
        self.criteria = criteria
        self.n = motion.n
        torques = map(motion.filtered_reading, (motion.tau, *predicted))
        sizes = np.sqrt([np.mean(torque**2, axis=0) for torque in torques])
        self.rms = sizes[0]
        self.largest = criteria.largest * sizes.max(axis=0)

    def accepts(self, comparison: StepComparison, alternative: Alternative) -> bool:
        """Whether an alternative is large enough to matter on at least one joint that it acts on,
        and no leftover of what is chosen there."""
        candidate = alternative.candidate
        if of_one_moment(candidate, comparison.chosen):
            return False
        if (self._size(candidate) > self.largest).any():
            return False  # a torque that something else must cancel again
        if alternative.rattles:
            return True  # its quick part is most of it, and in no column
        if of_the_clock(comparison, candidate, self.criteria.gain):
            return False
        matters = self.matters(comparison, alternative)
        if comparison.chosen and matters.any():
            matters &= self._new(comparison, candidate)
        return bool(matters.any()) and not self._once(comparison, candidate)

    def _size(self, candidate: Candidate) -> Array:
        """Rms torque on each joint, shape (n,) [Nm]."""
        return rms(candidate.torque(self.n))

    def most_on(self, candidate: Candidate) -> int:
        """The joint (from 1) of whose torque it is the largest share."""
        return int(np.argmax(self._size(candidate) / np.maximum(self.rms, 1e-12))) + 1

    def matters(self, comparison: StepComparison, alternative: Alternative) -> Mask:
        """Joints on which it is large enough, shape (n,)."""
        c = self.criteria
        candidate = alternative.candidate
        torque = candidate.torque(self.n)
        size = rms(torque)
        # by discrepancy from its law alone, which the base takes in: a good size speaks for it
        least = c.torque if alternative.by_its_law(c.by_law) else c.torque_beside_law
        shown = size
        if candidate.rattles:
            least = 0.0  # nine tenths of it are quicker than what is compared
        elif candidate.devices or (
            candidate.known and all(e.chain == "clock" for e in candidate.effects)
        ):
            shown = size / QUICK
        if candidate.devices:
            shown = np.maximum(shown, comparison.sampled_rms(candidate))
        large = (size > np.sqrt(c.energy * comparison.energy)) & (size > self.usual)
        against = self.rms if self.friction is None else self.friction.counted(torque, self.rms)
        return np.asarray(large & (shown > least * against))

    def said_by_less(
        self, comparison: StepComparison, alternative: Alternative, every: Sequence[Alternative]
    ) -> bool:
        """Whether an effect too small to be named says what another one or a non-parametric law of
        its joint says, and better: what does not matter by its name does not matter by a wrong one
        or without. Of one that rattles the size says little, what is said mostly by departures from
        a law is not said by its name, and some moments do not say what another name says of all.

        Args:
            comparison: of all alternatives.
            alternative: in question.
            every: alternatives, small ones too.
        """
        if alternative.rattles:
            return False
        named = alternative.candidate.known
        clearly = self.criteria.unknown if named else 0.0
        always = named and not alternative.candidate.begins
        return any(
            other.candidate.known
            and other.candidate.joint == alternative.candidate.joint
            and other.candidate.kind != alternative.candidate.kind
            and not other.candidate.rattles
            and not (other.candidate.begins and always)
            and other.evidence > alternative.evidence + clearly
            and other.by_its_law(self.criteria.by_law)
            and not self.matters(comparison, other).any()
            for other in every
        )

    def _once(self, comparison: StepComparison, candidate: Candidate) -> bool:
        """Whether one second of the record says it nearly alone: something happened there, which is
        no law.

        A force that comes and goes may be short, a swing may die out soon after the start, and what
        the base could take as well moves all of it.
        """
        short = any(stop < OPEN_END_S for e in candidate.effects for _, stop in e.windows_s)
        if (
            short
            or candidate.devices
            or comparison.share_beyond_base(candidate) < self.criteria.in_base
        ):
            return False
        return comparison.elsewhere(candidate) < self.criteria.elsewhere

    def _new(self, comparison: StepComparison, candidate: Candidate) -> Mask:
        """Joints where it is more than earlier laws of slightly another shape leave, shape (n,).

        It must take a good part off the residual there, or, where the base had been bent to hide
        it, gain a good part of the evidence.
        """
        c = self.criteria
        added = comparison.added(candidate)
        new = (
            np.ones(self.n, dtype=bool)
            if candidate.known
            else added > np.sqrt(c.energy * comparison.energy)
        )
        relieves = candidate.known and comparison.relieves_base(candidate)
        hidden = self._size(candidate) if relieves else np.zeros(self.n)
        for earlier in comparison.chosen:
            share = earlier.discrepancy_share
            # the swing of one transmission moves its neighbours' links too, a force that comes and
            # goes has no step's edges: there only the evidence speaks
            same = bool(candidate.devices & earlier.devices) or _once_more(candidate, earlier)
            # what the base has hidden and hides no more is new as a whole
            more = np.full(self.n, not same) & (
                np.maximum(added, hidden) > share * self._size(earlier)
            )
            # a flexible law has taken in whatever the base could hide there
            if candidate.known and earlier.known:
                more |= candidate.score.gain > (
                    share * earlier.score.gain if same else self._leaves(comparison, earlier)
                )
                if not more.all() and candidate.score.gain > c.gain:
                    leftover = comparison.leftover(earlier)
                    more |= (
                        leftover is not None
                        and comparison.gain_beside(candidate, leftover) > c.gain
                    )
            new &= more
        return new

    def least_gain(self, comparison: StepComparison, alternative: Alternative) -> float:
        """Log evidence that an alternative needs [nats]."""
        c = self.criteria
        candidate = alternative.candidate
        if alternative.rattles:
            return c.gain_rattling
        if not candidate.known:
            return c.non_parametric_gain
        if self.identified and all(e.chain == "clock" and not e.joint for e in candidate.effects):
            return c.gain_stated
        if not self.in_base(comparison, candidate):
            return c.gain
        if alternative.by_law < c.gain and candidate.has_own_shape:
            return c.gain  # of a shape of its own, which a misfit of another shape may pass for
        alone = c.gain_stated if candidate.expected else c.gain_in_base
        if FRICTION.intersection(LIBRARY[candidate.kind].ambiguity.change_of):
            alone = c.gain_changed
        # what an earlier law leaves bends the base
        acts = candidate.acts_on(self.n)
        left = [
            float(self._leaves(comparison, e)[acts].max(initial=0.0)) for e in comparison.chosen
        ]
        return min(c.gain, alone + max(left, default=0.0))

    def left_by(self, comparison: StepComparison, joint: int | None) -> float:
        """Log evidence that one of the chosen explanations may have left on a joint (from 1; None:
        on the one with most of it) [nats]."""
        place = slice(None) if joint is None else joint - 1
        left = (float(np.max(self._leaves(comparison, e)[place])) for e in comparison.chosen)
        return max(left, default=0.0)

    def _leaves(self, comparison: StepComparison, earlier: Candidate) -> Array:
        """Log evidence of what a law of slightly another shape may leave on each joint, shape (n,)
        [nats]."""
        gained = comparison.by_joint(earlier.score.gain, earlier.torque(self.n))
        return np.asarray(earlier.discrepancy_share**2 * gained)

    def in_base(self, comparison: StepComparison, candidate: Candidate) -> bool:
        """Whether other numbers of the robot would give all but a small share of a candidate."""
        return comparison.share_beyond_base(candidate) <= self.criteria.in_base

    def best(self, comparison: StepComparison, alternatives: Sequence[Alternative]) -> Alternative:
        """The best of the alternatives that may be taken; a non-parametric law only where it says
        more than the best effect, by more than that effect's own law and earlier ones may have
        left."""
        best = alternatives[0]
        known = next((r for r in alternatives if r.candidate.known), None)
        if best.candidate.known or known is None:
            return best
        # by less than the share that its law may leave
        close = comparison.gain(best) <= (
            1.0 + known.candidate.discrepancy_share
        ) * comparison.gain(known)
        mostly_base = comparison.share_beyond_base(known.candidate) < self.criteria.mostly_base
        if (close or mostly_base) and self._leaves_little(comparison, known, best):
            return known
        earlier = self.left_by(comparison, best.candidate.joint or 1)
        rival = known.evidence
        if close:
            rival = max(rival, comparison.with_its_leftover(known))
        needed = self.criteria.unknown + earlier
        return best if best.evidence - rival > needed else known

    def _leaves_little(
        self, comparison: StepComparison, known: Alternative, non_parametric: Alternative
    ) -> bool:
        """Whether a non-parametric law says hardly more than an effect, however clearly it says it.

        What one joint may have several of (ripples of any order) is a flexible function itself, but
        for a law that holds one of them with more freedom.
        """
        freer = non_parametric.candidate.freer == known.candidate.kind
        if not freer and any(e.search.repeats for e in known.candidate.effects):
            return False
        more = comparison.explained(non_parametric.candidate) - comparison.explained(
            known.candidate
        )
        # where the torque is not known a flexible law says anything
        says, law = map(comparison.known_rms, (more, known.candidate.torque(self.n)))
        place = (non_parametric.candidate.joint or 1) - 1
        return bool(says[place] < self.criteria.little * law[place])


def _once_more(candidate: Candidate, earlier: Candidate) -> bool:
    """Whether a candidate is an earlier one's effect again, one that a joint or an arm has once."""
    return (
        candidate.known
        and (candidate.kind, candidate.joint) == (earlier.kind, earlier.joint)
        and not any(e.search.repeats for e in candidate.effects)
    )
