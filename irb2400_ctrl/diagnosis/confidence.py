"""How surely a finding is right: a table measured on suites of arms with known truth, not a score."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.diagnosis.step import Step
from irb2400_ctrl.effects import LIBRARY

TABLE = ((0.0, 0.50), (3.0, 0.65), (10.0, 0.71), (30.0, 0.83), (100.0, 0.93), (1000.0, 0.97), (1e5, 0.985))
"""margin to the best other explanation [nats] -> share of right names"""

LOOKALIKE_CAP = 0.75
"""no finding is surer than this if a kind of another group passes for it: elastic joints were right in 2 of 4 (seed 900
and two arms with backlash; too few for more than a cap)"""

LIKELY = 12.0
"""[nats] rivals nearer than this are alternatives"""
LIKELY_SHARE = 0.06
"""and so are those nearer than this share of the finding's own gain"""


def confidence(step: Step) -> float:
    """Probability that kind and joint are right."""
    margins, shares = np.array(TABLE).T
    sure = float(np.interp(np.log1p(max(step.margin, 0.0)), np.log1p(margins), shares))
    return min(sure, LOOKALIKE_CAP) if _lookalikes(step) else sure


def alternatives(step: Step) -> tuple[str, ...]:
    """Kinds of the library that this log can not exclude, likeliest first."""
    best = next(r.evidence for r in step.rivals if r.candidate is step.candidate)
    found: list[str] = []
    own = step.candidate.kind
    for rival in step.rivals:
        kind = rival.candidate.kind
        if rival.candidate.known and kind != own and best - rival.evidence < LIKELY + LIKELY_SHARE * step.gain:
            found.append(kind)
    if step.candidate.known:
        group = LIBRARY[own].group
        for rival in step.rivals:
            kind = rival.candidate.kind
            near = best - rival.evidence < 0.4 * step.gain
            if rival.candidate.known and kind != own and near and LIBRARY[kind].group == group:
                found.append(kind)
    return tuple(dict.fromkeys((*found, *_lookalikes(step))))


def _lookalikes(step: Step) -> tuple[str, ...]:
    return LIBRARY[step.candidate.kind].lookalikes if step.candidate.known else ()
