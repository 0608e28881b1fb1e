"""`Clearance`: the smallest distance of a motion, between which bodies and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.arrays import Array


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


def entry(found: Clearance | None, way: Callable[[float], Array]) -> dict[str, Any]:
    """The entry in `plan.json`; `way`: of the TCP at a length along the joint path, both [m]."""
    if found is None:
        return unknown("the robot file has no [outline], the space that the arm takes up")
    at = float(way(found.s))
    return {"value": 1e3 * found.value, "pair": list(found.pair), "at_mm": 1e3 * at}


def unknown(reason: str) -> dict[str, Any]:
    """The entry in `plan.json` where nothing is known, and why."""
    return {"value": None, "pair": None, "at_mm": None, "reason": reason}
