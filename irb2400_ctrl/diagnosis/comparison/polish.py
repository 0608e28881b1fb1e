"""The nonlinear parameters of an effect with memory, searched on the evidence.

How the record began is free and changes with them, so the fit's slopes would mislead.
"""

from __future__ import annotations

from dataclasses import replace

from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Problem

WIDTHS = (0.1, 0.04, 0.015)
"""shares by which they move, one after the other"""
FAR = 0.4
"""the same before these, of a transmission's flaws: their grid's best point, judged under the noise
without them, may be far from the best. Not of those that are loose: a spring that is too soft asks
for no damping, or for all of it"""
ASKED = 5.0
"""[nats] for which those that are loose leave what is usual"""


def polished(scan: Scan, problem: Problem, candidate: Candidate) -> Candidate:
    """The candidate at the best point that a search by coordinates finds, with its spread.

    Args:
        scan: with its columns; problem: what it is to explain.
        candidate: of one effect, at a point of the grid.
    """
    best = candidate
    (effect,) = candidate.effects
    nonlinear = effect.nonlinear
    for width in (FAR, *WIDTHS) if effect.search.device else WIDTHS:
        for key in nonlinear:
            loose = key in effect.prior.loose
            if loose and width == FAR:
                continue
            spread = (1 + width) ** (8 if loose else 1)
            trials = [{**nonlinear, key: nonlinear[key] * spread**k} for k in (-2, -1, 1, 2)]
            for trial in trials:
                moved = scan.moved(problem, best, trial)
                if moved is not None and moved.score.gain > best.score.gain + loose * ASKED:
                    best = moved
                    nonlinear = trial
    return replace(best, spread=_spread(scan, problem, best))


def _spread(scan: Scan, problem: Problem, best: Candidate) -> dict[str, float]:
    """Standard errors from the curvature of the evidence: gain(p + h) + gain(p - h) = 2 gain(p) -
    (h / sigma)^2."""
    found = {}
    nonlinear = best.effects[0].nonlinear
    for key, value in nonlinear.items():
        for share in (0.01, 0.05, 0.2):
            trials = [
                scan.moved(problem, best, {**nonlinear, key: value * (1 + side * share)})
                for side in (-1, 1)
            ]
            drop = sum(best.score.gain - trial.score.gain for trial in trials if trial is not None)
            if None not in trials and drop > 1.0:
                found[key] = share * value / float(drop**0.5)
                break
    return found
