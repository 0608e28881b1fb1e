"""`Separability`: how well a motion tells one member of an ambiguity group from a rival."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.excitation.alternatives import named
from irb2400_ctrl.excitation.groups import Place

CLEAR = 5.0
"""standard deviations from which on members are called separated"""


@dataclass(frozen=True)
class Separability:
    """How far a member is from what a rival and the uncertain base can imitate: standard motion,
    then planned one.

    Args:
        pair: in words; member, rival: kind and joint, rival None for the base alone.
        distance: [standard deviations of the assumed noise]; sine: of the angle between the member
            and its imitation.
        ceiling: largest distance that any record could show where no motion separates them, else
            infinite.
        reason: why no motion separates them; empty where one may.
    """

    pair: str
    member: Place
    rival: Place | None
    distance: tuple[float, float]
    sine: tuple[float, float]
    ceiling: float
    reason: str

    @property
    def separated(self) -> bool:
        """Whether the planned motion tells them apart, the data sheet's word included."""
        return self.distance[1] >= CLEAR

    @property
    def hopeless(self) -> bool:
        """Whether no motion tells them apart, at the common size."""
        return self.ceiling < CLEAR

    @property
    def verdict(self) -> str:
        """In words, for tables."""
        if self.hopeless:
            return "no motion separates them"
        if not self.separated:
            return "still close"
        return "only by the data sheet" if self.reason else "separated"

    def row(self) -> dict[str, Any]:
        """For `excitation.json`."""
        return {
            "member": named(self.member),
            "rival": "uncertain base" if self.rival is None else named(self.rival),
            "distance_before": round(self.distance[0], 3),
            "distance_after": round(self.distance[1], 3),
            "sine_before": round(self.sine[0], 5),
            "sine_after": round(self.sine[1], 5),
            "separable_by_motion": not self.reason,
            "verdict": self.verdict,
            "largest_distance_of_any_record": round(self.ceiling, 3)
            if math.isfinite(self.ceiling)
            else None,
            "why_not": self.reason,
        }
