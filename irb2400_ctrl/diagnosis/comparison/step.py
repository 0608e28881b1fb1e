"""What a step of the selection settles on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate

ONE_MOMENT = 1.0
"""[s] what begins nearer in time than this began for one reason"""


@dataclass(frozen=True)
class Step:
    """One accepted explanation.

    Args:
        candidate: accepted; gain: log evidence over the model without it; alternatives: others,
            best first.
        validation_gain: per cent that it takes off the rms error of each joint on unseen rows,
            shape (n,).
        one_of_two: whether it counts only with another one of its joint, in the place of a
            non-parametric law that takes in both.
    """

    candidate: Candidate
    gain: float
    alternatives: tuple[Alternative, ...]
    validation_gain: Array | None = None
    one_of_two: bool = False

    def only(self, members: Sequence[bool]) -> Step:
        """The same with some effects of its candidate."""
        candidate = self.candidate.only(members)
        alternatives = tuple(
            replace(r, candidate=candidate) if r.candidate is self.candidate else r
            for r in self.alternatives
        )
        return replace(self, candidate=candidate, alternatives=alternatives)

    def behind(self, other: Alternative) -> float:
        """Evidence of the candidate over that of another explanation [nats]."""
        best = next(r.evidence for r in self.alternatives if r.candidate is self.candidate)
        return best - other.evidence

    @property
    def margin(self) -> float:
        """Evidence over the best other effect of the library [nats]; the gain itself where there is
        none.

        For a non-parametric law: over the best effect. A flexible function of the same signals is
        no rival of a law.
        """
        others = [
            self.behind(r)
            for r in self.alternatives
            if r.candidate.known and not _same(r.candidate, self.candidate)
        ]
        return float(min([*others, self.gain]))


def _same(one: Candidate, other: Candidate) -> bool:
    """Whether two candidates say the same, one of them perhaps for every joint."""
    return one.kind == other.kind and (one.joint == other.joint or None in (one.joint, other.joint))


def of_the_whole_arm(steps: Sequence[Step], n: int) -> bool:
    """Whether what has no name is on more than half of n joints, and on more than one: something
    acts on the whole arm, and the robot's numbers bend with it."""
    return 2 * len({s.candidate.joint for s in steps if not s.candidate.known}) > max(n, 2)


def without_its_other(steps: Sequence[Step]) -> int | None:
    """Place of an explanation that counts only beside another one of its joint, which did not come;
    None if there is none."""
    joints = [s.candidate.joint for s in steps]
    for place, step in enumerate(steps):
        if step.one_of_two and joints.count(step.candidate.joint) == 1:
            return place
    return None


def apart(steps: Sequence[Step]) -> list[Step]:
    """Explanations, but for those `of_one_moment` with another one."""
    return [
        s
        for s in steps
        if not of_one_moment(s.candidate, [other.candidate for other in steps if other is not s])
    ]


def of_one_moment(candidate: Candidate, others: Sequence[Candidate]) -> bool:
    """Whether a larger effect begins at the same moment: what else begins then its simple law has
    left over."""
    return any(
        abs(start - moment) < ONE_MOMENT and candidate.score.gain < other.score.gain
        for other in others
        for start in candidate.begins
        for moment in other.begins
    )
