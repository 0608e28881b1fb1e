"""Inertial numbers of the robot file that a log puts far outside their own uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.base_prior import named_bodies
from irb2400_ctrl.robot import Robot

FAR = 3.5
"""standard deviations"""
NUMBERS = (
    "mass_kg",
    *(f"com_{axis}_m" for axis in "xyz"),
    *(f"inertia_{axes}_kgm2" for axes in ("xx", "yy", "zz", "xy", "xz", "yz")),
)


@dataclass(frozen=True)
class MovedNumber:
    """One number of a body.

    Args:
        body: name of the link, or `tool`; place: of the body from 1, n + 1 for the tool.
        number: as in NUMBERS; by: how far the log moves it, in its own standard deviations.
    """

    body: str
    place: int
    number: str
    by: float

    def to_json(self) -> dict[str, str | float]:
        """As in findings.json."""
        return {
            "body": self.body,
            "number": self.number,
            "standard_deviations": round(self.by, 2),
        }


def moved_numbers(robot: Robot, z: Array) -> tuple[MovedNumber, ...]:
    """Those of the base's fitted z, shape (10 per body, friction ...), that lie far out."""
    found = []
    for i, (_, name) in enumerate(named_bodies(robot)):
        for k, number in enumerate(NUMBERS):
            by = float(z[10 * i + k])
            if abs(by) > FAR:
                found.append(MovedNumber(name, i + 1, number, by))
    return tuple(found)


def sentence(moved: Sequence[MovedNumber], n: int) -> str:
    """Plain words for the bodies whose numbers moved; empty for none.

    Args:
        n: number of links.
    """
    if not moved:
        return ""
    places = sorted({number.place for number in moved})
    far = max(moved, key=lambda number: abs(number.by))
    if places == [n + 1]:
        text = "The inertial numbers of the tool are off: is the load declared?"
    else:
        links = _ranges([place for place in places if place <= n])
        tool = " and of the tool" if n + 1 in places else ""
        text = f"The inertial numbers of {links}{tool} are off."
    size = f"{abs(far.by):.1f} of its own standard deviations"
    return f"{text} {far.number} of {far.body} moved by {size}."


def _ranges(places: Sequence[int]) -> str:
    """`link 3`, `links 4-6`, `links 2, 4-6`."""
    runs = []
    for _, group in groupby(enumerate(places), key=lambda pair: pair[1] - pair[0]):
        run = [place for _, place in group]
        runs.append(str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}")
    return f"link{'s' if len(places) > 1 else ''} {', '.join(runs)}"
