"""Numbers of the robot that are further off than stated, as a rival of the best name."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison.comparison import StepComparison
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.estimation.fit import Fitter


def rather_wider(
    scan: Scan, fitter: Fitter, beside: StepComparison, step: Step | None, criteria: Criteria
) -> Array | None:
    """How many times further off than stated each number of the robot explains more than two such
    steps as the best one, shape (own,); None where they do not.

    Args:
        scan: of the log; fitter: of its fits.
        beside: what is chosen so far.
        step: the best further explanation; None for none.
        criteria: when an explanation counts.
    """

    def gained(wider: Array) -> float:
        Z = beside.Z.copy()
        Z[:, :, : fitter.own] *= wider
        there = StepComparison(scan, fitter.noise, beside.y, Z).base
        return float(there.log_evidence - beside.base.log_evidence)

    # numbers further off take in several effects at once, of which the best alone says less
    c = criteria
    least = c.gain if step is None else (1.0 + c.two_at_once) * step.gain + c.gain_stated
    ways = ways_of(fitter, c.wider)
    gains = [gained(way) for way in ways]
    best = ways[int(np.argmax(gains))]
    if max(gains) <= least:
        return None
    # friction that is otherwise on one joint alone has a name, or hides what has none
    alone = (gained(one) <= least for one in but_for_a_joint(fitter, best))
    return None if any(alone) else best


def ways_of(fitter: Fitter, factors: Sequence[float]) -> list[Array]:
    """Ways in which the robot's numbers may be so many times further off: all, or those of friction
    alone, which wear and temperature change; of each number, shape (own,)."""
    all_of_them = [np.full(fitter.own, factor) for factor in factors]
    if not fitter.friction:
        return all_of_them
    bodies = np.arange(fitter.own) < fitter.own - fitter.friction
    return [*all_of_them, *[np.where(bodies, 1.0, factor) for factor in factors]]


def but_for_a_joint(fitter: Fitter, wider: Array) -> list[Array]:
    """Of a way that lets friction alone be further off, the same with the friction of a joint as
    stated, for each joint; of any other, nothing."""
    first = fitter.own - fitter.friction
    if not fitter.friction or wider[0] != 1.0:
        return []
    joints = np.arange(fitter.friction) % (fitter.friction // 3)
    found = []
    for joint in range(fitter.friction // 3):
        way = wider.copy()
        way[first:][joints == joint] = 1.0
        found.append(way)
    return found
