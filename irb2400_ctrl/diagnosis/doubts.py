"""What makes an answer weaker than its numbers: a search that did not settle, what was seen too
seldom."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from irb2400_ctrl.diagnosis.comparison.confidence import LOOKALIKE_CAP
from irb2400_ctrl.diagnosis.diagnosis import Diagnosis
from irb2400_ctrl.diagnosis.finding import Finding
from irb2400_ctrl.diagnosis.preparation.quick_rests import Moments
from irb2400_ctrl.effects.linkage_inertia import LinkageInertia
from irb2400_ctrl.effects.process_force import A_MOMENT

ONCE = (
    "joint {joint}: what is left goes with {law}, but seconds that were not fitted are predicted "
    "no better with that: it is seldom in this log, or something else; record more of it"
)
SUSPECTED = 0.5
"""no name is surer where names come and go with each other: of five on two arms, with a force that
chatters and a load that leaks, two were right"""
REST_OF = {
    "hysteresis": ("cable_spring", "wrist_coupling"),
    "viscous_change": ("viscous_warmup",),
}
"""what another one of the joint looks like where it is off its law: a cable creeps, a coupling has
dry friction of its own (three such loops of 0.89 to 0.94 were wrong), grease that warms up fast and
then slowly is still cold at the end (three such changes of 0.83 to 0.92 were wrong)"""


def suspected(
    found: tuple[Finding, ...], unsettled: bool, moments: Moments | None
) -> tuple[Finding, ...]:
    """Names that are not as sure as their evidence.

    Args:
        found: names; unsettled: whether the search for them did not settle: then no name is sure
            but of what every robot has.
        moments: at which several joints are far off: readings that stand still now and then are
            late on average, and were a delay of all joints at 0.94 to 0.97.
    """

    def most(one: Finding) -> float:
        if unsettled and one.list != "lacks":
            return SUSPECTED
        # a lever that weighs something has an inertia: told by its weight alone it was a gain, a
        # balancer or nothing on four of eight arms
        if isinstance(one.effect, LinkageInertia) and one.effect.inertia_kgm2 == 0.0:
            return SUSPECTED
        beside = {e.effect.kind for e in found if e.effect.joint == one.effect.joint}
        if beside & set(REST_OF.get(one.effect.kind, ())):
            return LOOKALIKE_CAP
        # readings that stood still were a base that tilts for 0.09 s, at 0.96
        windows = one.effect.windows_s
        if windows and all(stop - start < A_MOMENT for start, stop in windows):
            return LOOKALIKE_CAP
        return LOOKALIKE_CAP if moments and one.effect.chain == "clock" else 1.0

    return tuple(replace(one, confidence=min(one.confidence, most(one))) for one in found)


def seldom_met(found: Diagnosis, laws: Mapping[int, str]) -> list[str]:
    """A sentence for each joint of which no more is known than a law that unseen rows did not bear
    out; `laws` by joint."""
    told = [one.joint for one in found.unexplained]
    joints = [j for j in found.beyond_noise if j in laws and j not in told]
    return [ONCE.format(joint=j, law=laws[j]) for j in joints]
