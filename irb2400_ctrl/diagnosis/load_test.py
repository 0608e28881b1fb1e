"""Whether numbers moved together as a load on the flange moves them, each within what is stated.

A load of a few kilograms spreads over the masses, centres and inertias of the last bodies, none of
which need go far. With the numbers as uncertain as they are taken, torques y ~ N(0, 1 + Z Z^T)
without a load and N(X m, 1 + Z Z^T) with a mass m on the flange's axis, so that

    T = X^T P y / (X^T P X)^(1/2),    P = (1 + Z Z^T)^-1

is a standard normal variable without one, and m = X^T P y / X^T P X. One direction is asked, not
all ten of a body: a law with a name is asked to gain more than other numbers of the robot could
mean, this only says that they moved.
"""

from __future__ import annotations

import numpy as np

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
    law, _ = scan.member(KIND, None, {})
    on_axis, *_ = scan.forms(KIND, law)
    columns = RegressorColumns(law.joints, law.values @ on_axis.columns)
    Z = fit.Z.copy()
    Z[:, :, : fitter.own] *= fitter.widened
    gram, right = Problem(fit.y, Z, fit.noise).projected(columns)
    size = float(np.sqrt(gram[0, 0]))
    sigmas = float(right[0]) / size
    if abs(sigmas) < TOLD:
        return ()
    which: FindingList = "changed" if change else "special"
    return (Number(which, "tool", LOAD, 0.0, sigmas / size, 1.0 / size, sigmas),)
