"""The sign of a joint's angle and that of its torque: of a wrist that is alike on both sides
torques do not tell which of the two is turned over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from irb2400_ctrl.plausibility.evidence import Fit
from irb2400_ctrl.plausibility.problem import LogProblem
from irb2400_ctrl.plausibility.reading import Reading, turned

AS_WELL = 12.0
"""twice the log evidence within which two signs fit as well"""
OTHER = {"angle_sign": "torque_sign", "torque_sign": "angle_sign"}
WORDS = {"angle_sign": "angle", "torque_sign": "torque"}


def with_its_rival(reading: Reading, best: Fit, fit: Callable[[Reading], Fit]) -> LogProblem:
    """What a log looks like; of a sign with the other one, where that fits as well.

    Args:
        reading: that is taken; best: its fit.
        fit: how well another is explained.
    """
    says = reading.says
    other = OTHER.get(reading.kind)
    if other and reading.joints and says == turned(reading.kind, reading.joints):
        rival = replace(reading, kind=other, angles=reading.torques, torques=reading.angles)
        if fit(rival).cost < best.cost + AS_WELL:
            several = len(reading.joints) > 1
            word = WORDS[other]
            its = f"their {word}s, which fit" if several else f"its {word}, which fits"
            says = f"{says}; or {its} as well: jog, and see whether the angle goes the file's way"
    return LogProblem(reading.kind, says, dict(reading.fits), reading.joints)
