"""Friction that the robot file does not state, beside a law without a name on the same joint.

A flexible function of the speed takes in a dry friction as readily as the friction's own column
does, which is free as well: the robot would be written without any. What a file can hold is the
file's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.diagnosis.preparation.identified_prior import AnyPrior, IdentifiedPrior


def with_friction_first(prior: AnyPrior, fit: Fit) -> Fit:
    """The fit with as much of its laws without a name as unknown dry and viscous friction could
    make given to these; together they are what they were.

    With F the columns of that friction and t the torque of a law on its joint, per joint:
    d = argmin |t - F d|,  z_F becomes z_F + d,  t becomes t - F d.
    """
    robot = prior.robot
    if isinstance(prior, IdentifiedPrior) or not fit.non_parametric:
        return fit
    n = robot.n
    z = fit.z.copy()
    laws = []
    first = len(prior.sigmas()) - 3 * n
    unknown = ~robot.friction_stated[:, 1:3]
    for torque in fit.non_parametric:
        left = torque.copy()
        for j in np.flatnonzero(torque.any(axis=0)):
            columns = [first + kind * n + j for kind in range(2) if unknown[j, kind]]
            F = fit.Z[:, j, columns]
            d = np.linalg.lstsq(F, left[:, j], rcond=1e-9)[0]
            z[columns] += d
            left[:, j] -= F @ d
        laws.append(left)
    return replace(fit, z=z, non_parametric=tuple(laws))
