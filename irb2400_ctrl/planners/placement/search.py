"""The search for the best place: a coarse look over the area, a closer one around the best."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from irb2400_ctrl.planners.placement.area import Area, Standing
from irb2400_ctrl.planners.placement.outlook import Outlook

Look = Callable[[Standing], Outlook]

SPACING = 0.3
"""between the places of the coarse look [m]"""
CLOSER = 4
"""how many of them are looked at more closely"""
APART = 0.25
"""these stand at least so far apart [m], or are turned"""
STEP = 0.12
"""of the closer look, at first [m]"""
TURN = np.radians(30.0)
FINEST = 0.015
"""where it ends [m]"""
MOST_LOOKS = 70
"""around each of them"""


@dataclass
class Search:
    """What was seen so far."""

    area: Area
    seen: list[tuple[Standing, Outlook]] = field(default_factory=list)

    def coarse(self, promising: Callable[[Standing], bool], look: Look) -> None:
        """Look from every place of a grid that is promising."""
        for middle in self.area.grid(SPACING):
            for turn in self.area.turns:
                at = Standing(middle, float(turn))
                if promising(at):
                    self.seen.append((at, look(at)))

    def best(self) -> list[tuple[Standing, Outlook]]:
        """The best places so far, apart from each other."""
        found: list[tuple[Standing, Outlook]] = []
        ordered = sorted(self.seen, key=lambda pair: pair[1].rank, reverse=True)
        for at, outlook in ordered:
            if all(_apart(at, other) for other, _ in found):
                found.append((at, outlook))
            if len(found) == CLOSER:
                break
        return found

    def closer(self, start: Standing, look: Look) -> tuple[Standing, Outlook]:
        """Step by step to better places, in smaller and smaller steps (compass search)."""
        at = start
        best = look(at)
        looks = 1
        step = STEP
        turn = TURN
        while step > FINEST and looks < MOST_LOOKS:
            moved = False
            for other in self._around(at, step, turn):
                found = look(other)
                looks += 1
                self.seen.append((other, found))
                if found.rank > best.rank:
                    at = other
                    best = found
                    moved = True
                    break
            if not moved:
                step /= 2
                turn /= 2
        return at, best

    def _around(self, at: Standing, step: float, turn: float) -> list[Standing]:
        ways = [step * sign * axis for axis in np.eye(3) for sign in (1.0, -1.0)]
        moved = [Standing(at.middle + way, at.turn) for way in ways]
        if self.area.turning:
            moved += [Standing(at.middle, at.turn + sign * turn) for sign in (1.0, -1.0)]
        return [other for other in moved if self.area.holds(other.middle)]


def _apart(a: Standing, b: Standing) -> bool:
    far = float(np.linalg.norm(a.middle - b.middle)) > APART
    return far or abs(np.sin((a.turn - b.turn) / 2)) > np.sin(TURN)
