"""`Clearance`: the smallest distance of a motion, between which bodies and where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Clearance:
    """Over the continuous path."""

    value: float
    """lower bound of the distance, at every place of the path and for every pair [m]; where the
    path is not free, the distance at the place named"""
    pair: tuple[str, str]
    """the two bodies that come nearest"""
    s: float
    """where, as a length along the joint path [m]"""
    free: bool
    """whether it is shown that what is to be kept is kept everywhere"""
    keep: float = 0.0
    """what is to be kept between the two [m]"""

    def summary(self, at: float) -> dict[str, Any]:
        """Its entry in `plan.json`.

        Args:
            at: the place as a length of the TCP's way [m].
        """
        return {"value": 1e3 * self.value, "pair": list(self.pair), "at_mm": 1e3 * at}


def unknown(reason: str) -> dict[str, Any]:
    """The entry in `plan.json` where nothing is known, and why."""
    return {"value": None, "pair": None, "at_mm": None, "reason": reason}
