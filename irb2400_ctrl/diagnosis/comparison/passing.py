"""Laws that another one of the joint passes for, plausible by themselves or not: where one of them
says as much, that other is none to be sure of."""

from __future__ import annotations

from dataclasses import replace

from irb2400_ctrl.diagnosis.comparison.comparison import StepComparison
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.gear_ripple import GearRipple

SKEW = 1e-3
"""[s] by which torques may be told early or late, all alike, without a word in time stamps"""


def of_the_clock(comparison: StepComparison, candidate: Candidate, least: float) -> bool:
    """Whether a soft transmission says hardly more than that torques are told by a part of a sample
    early: in a quick motion its lag looks like that.

    Args:
        comparison: of all candidates.
        candidate: any.
        least: that it must gain beside the clock [nats].
    """
    if not candidate.devices:
        return False
    _, laws = comparison.scan.laws["time_delay", None]
    return comparison.gain_beside(candidate, SKEW * laws[0].values) < least


def slow_ripple(scan: Scan, problem: Problem, joint: int) -> Candidate:
    """The best ripple of one of `GearRipple.SLOW` orders.

    Args:
        scan: of the log; problem: to score them on.
        joint: counted from 1.
    """
    orders = [{"order": order} for order in GearRipple.SLOW]
    found = [_member(scan, problem, ("gear_ripple", joint), point) for point in orders]
    return max(found, key=lambda c: c.score.gain)


def springs(scan: Scan, problem: Problem, joint: int) -> list[Candidate]:
    """Soft transmissions at the resonances worth a look.

    Args:
        scan: of the log; problem: to score them on.
        joint: counted from 1.
    """
    family = ("elastic_joint", joint)
    grid, laws = scan.laws.get(family, ([], []))
    if not laws:  # no stiffness of the grid swings as records show: a light axis
        return []
    places = scan.promising(problem, *family, laws)
    return [_member(scan, problem, family, grid[place]) for place in places]


def _member(
    scan: Scan, problem: Problem, family: tuple[str, int], point: dict[str, float]
) -> Candidate:
    """A member of a family in its first form."""
    kind, joint = family
    form = scan.forms(kind, scan.member(*family, point)[0])[0]
    tried = scan.in_form(problem, family, point, form, scan.family_penalty(*family, point))
    numbers = (form.columns @ tried.score.coefficients).tolist()
    effect = LIBRARY[kind].from_coefficients(joint, numbers, point)
    return replace(tried, effects=(effect,))
