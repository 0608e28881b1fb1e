"""Numbers of a robot beside something that acts on the whole arm and has no name.

Flexible laws of most joints and the robot's numbers trade torque with each other, and without the
former the latter explain a log worse than before. They are fitted as if what has no name were
noise, and of those that the file states none is said to be another one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.posterior import Posterior

BENT = (
    "what has no name is on most joints and bends the robot's numbers: none is told, and those of "
    "robot.toml are a record of this log (if the robot file is a rough one: irb2400 identify "
    "LOG... --out arm, and diagnose with that file)"
)


def beside_noise(fitter: Fitter, steps: Sequence[Step], fit: Fit) -> Fit:
    """The fit, with the robot's numbers as they are where what has no name is noise, no further
    off than stated, and what has no name as what these numbers leave of it.

    Args:
        fitter: of the log.
        steps: that were accepted.
        fit: of all of them, its deviations in stated standard deviations.
    """
    fitter.widen(1.0 / fitter.widened)
    named = fitter.fit([s.candidate for s in steps if s.candidate.known])
    laws = range(len(fit.effects), len(fit.effects) + len(fit.non_parametric))
    columns = [fit.Z[:, :, fit.owner == law] for law in laws]
    b = Posterior(named.residual, np.concatenate(columns, axis=2), named.noise).mean
    parts = np.split(b, np.cumsum([one.shape[2] for one in columns])[:-1])
    torques = tuple(one @ part for one, part in zip(columns, parts, strict=True))
    return replace(
        fit,
        z=named.z,
        z_covariance=named.z_covariance,
        non_parametric=torques,
        residual=named.residual - sum(torques),
    )
