"""How surely a finding is right: a table measured on suites of arms with known truth, not a
score."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.gear_ripple import GearRipple

TABLE = (
    (0.0, 0.48),
    (3.0, 0.76),
    (30.0, 0.89),
    (100.0, 0.935),
    (300.0, 0.96),
    (1000.0, 0.98),
    (1e5, 0.99),
)
"""margin to the best other explanation [nats] -> share of right names

Measured on 711 findings, 214 on the first plant (single effects and pairs, seeds 2027 to 2029) and
497 on the second (nine seeds): right in 38 of 70 below 3, mostly a dry friction that differs by
direction against an offset, 194 of 220 from 3 to 100, 258 of 271 from 100 to 1000, 138 of 139
above.
"""

LOOKALIKE_CAP = 0.75
"""no finding is surer than this if a kind of another group passes for it, or what is in no library:
elastic joints were right in 12 of 17"""

SLOW_RIPPLE_CAP = 0.5
"""no cable spring is surer that a ripple of its joint passes for over the travel: on 58 arms of a
plant (not part of this project) whose gears have ripples of few periods a turn, 1 of 11 was right;
with springs and no such ripple (second and third plant) none had one for an alternative"""

LITTLE_GAIN = 45.0
"""[%] of a joint's error on unseen rows, and"""
LITTLE_SHARE = 0.1
"""of its torque: a name that says less of both is of the size of details that no library names"""
LITTLE_CAP = 0.5
"""no such name is surer that details look like (`Ambiguity.like_details`): on the second and the
third plant (seeds 20263240 to 20263301) about half were right, on 58 arms of a plant whose gears,
drives and recorders have such details (not part of this project) 0 of 14"""

LIKELY = 12.0
"""[nats] others nearer than this are alternatives"""
LIKELY_SHARE = 0.06
"""and so are those nearer than this share of the finding's own gain, and"""
ALIKE_SHARE = 0.4
"""than this of the same group"""


def confidence(step: Step) -> float:
    """Probability that kind and joint are right."""
    margins, shares = np.array(TABLE).T
    sure = float(np.interp(np.log1p(max(step.margin, 0.0)), np.log1p(margins), shares))
    if any(_ripples_alike(step, other) for other in step.alternatives):
        return min(sure, SLOW_RIPPLE_CAP)
    mistaken = any(e.mistaken_for for e in step.candidate.effects)
    return min(sure, LOOKALIKE_CAP) if mistaken or _lookalikes(step) else sure


def of_name(step: Step, effect: Effect, gain: float | None, share: float) -> float:
    """Probability that the kind and joint of a name are right.

    Args:
        step: by which it was found.
        effect: that was named.
        gain: as of `says_little`; None where nobody knows.
        share: as of `says_little`.
    """
    sure = confidence(step)
    little = gain is not None and says_little(effect, gain, share)
    return min(sure, LITTLE_CAP) if little else sure


def says_little(effect: Effect, gain: float, share: float) -> bool:
    """Whether a name says so little that something without one may stand behind it.

    Args:
        effect: that was named.
        gain: per cent by which the error of the joint that shows it best falls on unseen rows.
        share: of that effect in the torque of the joint of which it makes most.
    """
    small = gain < LITTLE_GAIN and share < LITTLE_SHARE
    # details are of one joint or of its load: no such thing makes all torques late alike
    clock = effect.chain == "clock" and effect.joint is None
    return small and effect.ambiguity.like_details and not clock


def alternatives(step: Step) -> tuple[str, ...]:
    """Kinds of the library that this log can not exclude, likeliest first."""
    own = step.candidate
    others = [a for a in step.alternatives if a.candidate.known and a.candidate.kind != own.kind]
    near = [a.candidate.kind for a in others if _near(step, a)]
    if own.known:
        group = LIBRARY[own.kind].ambiguity.group
        likely = [a.candidate.kind for a in others if step.behind(a) < ALIKE_SHARE * step.gain]
        near += [kind for kind in likely if LIBRARY[kind].ambiguity.group == group]
    return tuple(dict.fromkeys((*near, *_lookalikes(step))))


def _near(step: Step, other: Alternative) -> bool:
    """Whether another explanation may be in the place of this one."""
    return step.behind(other) < LIKELY + LIKELY_SHARE * step.gain


def _ripples_alike(step: Step, other: Alternative) -> bool:
    """Whether another explanation is a ripple that passes for this one, on the same joint."""
    own = step.candidate
    return (
        own.kind in GearRipple.ambiguity.passing
        and (other.candidate.kind, other.candidate.joint) == ("gear_ripple", own.joint)
        and _near(step, other)
    )


def _lookalikes(step: Step) -> tuple[str, ...]:
    return LIBRARY[step.candidate.kind].ambiguity.lookalikes if step.candidate.known else ()
