"""What makes an answer weaker than its numbers: a search that did not settle, what was seen too
seldom."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from irb2400_ctrl.diagnosis.diagnosis import Diagnosis
from irb2400_ctrl.diagnosis.finding import Finding

ONCE = (
    "joint {joint}: what is left goes with {law}, but seconds that were not fitted are predicted "
    "no better with that: it is seldom in this log, or something else; record more of it"
)
SUSPECTED = 0.5
"""no name is surer where names come and go with each other: of five on two arms, with a force that
chatters and a load that leaks, two were right"""


def suspected(found: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """With no name that is sure, but of what every robot has."""
    return tuple(
        one if one.list == "lacks" else replace(one, confidence=min(one.confidence, SUSPECTED))
        for one in found
    )


def seldom_met(found: Diagnosis, laws: Mapping[int, str]) -> list[str]:
    """A sentence for each joint of which no more is known than a law that unseen rows did not bear
    out; `laws` by joint."""
    told = [one.joint for one in found.unexplained]
    joints = [j for j in found.beyond_noise if j in laws and j not in told]
    return [ONCE.format(joint=j, law=laws[j]) for j in joints]
