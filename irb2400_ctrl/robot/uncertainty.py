"""How far the numbers of a robot file may be off."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Uncertainty:
    """One standard deviation of what a robot file, made from data sheets, says.

    Args:
        mass, inertia, friction: relative; com: [m].
        static: relative, of the static friction, which a moving arm hardly shows.
    """

    mass: float = 0.02
    com: float = 0.005
    inertia: float = 0.05
    friction: float = 0.04
    static: float = 0.25
