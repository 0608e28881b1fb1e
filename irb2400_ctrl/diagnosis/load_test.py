"""Whether numbers moved together as a load on the flange moves them, each within what is stated.

A load of a few kilograms spreads over the masses, centres and inertias of the last bodies, none of
which need go far. With the numbers as uncertain as they are taken, torques y ~ N(0, 1 + Z Z^T)
without a load and N(X m, 1 + Z Z^T) with a mass m on the flange's axis, so that

    T = X^T P y / (X^T P X)^(1/2),    P = (1 + Z Z^T)^-1

is a standard normal variable without one, and m = X^T P y / X^T P X. As everywhere, errors that
come from the noise are taken `INFLATION` times as large, k: the variance of X^T P y is
X^T P (k^2 + Z Z^T) P X then, and k^2 X^T P X where the numbers themselves come from the noise of a
reference's logs. One direction is asked, not all ten of a body: a law with a name is asked to gain
more than other numbers of the robot could mean, this only says that they moved.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.diagnosis.comparison.acceptance import INFLATION
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.lists import FindingList
from irb2400_ctrl.diagnosis.numbers import LOAD, Number
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns

KIND = "payload"
TOLD = 3.0
"""standard deviations of T: beyond them are 0.27 % of the arms whose numbers are as stated"""


def moved_as_by_a_load(scan: Scan, fitter: Fitter, fit: Fit, change: bool) -> tuple[Number, ...]:
    """The mass on the flange's axis that would move the numbers as they moved, where it is told
    from none.

    Args:
        fit: of all that was found; a load among it leaves nothing to tell.
        change: whether the robot given is a reference of this very arm.
    """
    if any(effect.kind == KIND for effect in fit.effects):
        return ()
    law, _ = scan.member(KIND, None, {})
    on_axis, *_ = scan.forms(KIND, law)
    columns = RegressorColumns(law.joints, law.values @ on_axis.columns)
    Z = fit.Z.copy()
    Z[:, :, : fitter.own] *= fitter.widened
    problem = Problem(fit.y, Z, fit.noise)
    gram, right = problem.projected(columns)
    torque = columns.torque(np.ones(1), scan.motion.n)
    left = torque - Z @ (problem.z - problem.base_beside(torque))
    information = float(gram[0, 0])
    if information * on_axis.coefficients[0][1] ** 2 < 1.0:
        return ()  # a load of a usual size would not be seen, as on the only axis of an arm
    by_noise = float(sum(np.sum(n.whiten(left[:, j]) ** 2) for j, n in enumerate(fit.noise)))
    if fitter.robot.identified is not None:
        by_noise = information
    spread = float(np.sqrt(information + (INFLATION**2 - 1.0) * by_noise))
    sigmas = float(right[0]) / spread
    if abs(sigmas) < TOLD:
        return ()
    which: FindingList = "changed" if change else "special"
    mass = float(right[0]) / information
    return (Number(which, "tool", LOAD, 0.0, mass, spread / information, sigmas),)
