"""Whether numbers moved together as a load on the flange moves them, each within what is stated.

A load of a few kilograms spreads over the masses, centres and inertias of the last bodies, none of
which need go far: its mass on the flange's axis is the one number (`one_number.py`). One direction
is asked, not all ten of a body: a law with a name is asked to gain more than other numbers of the
robot could mean, this only says that they moved.
"""

from __future__ import annotations

from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.lists import FindingList
from irb2400_ctrl.diagnosis.numbers import LOAD, Number
from irb2400_ctrl.diagnosis.one_number import TOLD, OneNumber
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns

KIND = "payload"


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
    identified = fitter.robot.identified is not None
    load = OneNumber(fitter, fit).along(columns, all_noise=identified)
    if load.information * on_axis.coefficients[0][1] ** 2 < 1.0:
        return ()  # a load of a usual size would not be seen, as on the only axis of an arm
    if abs(load.sigmas) < TOLD:
        return ()
    which: FindingList = "changed" if change else "special"
    return (Number(which, "tool", LOAD, 0.0, load.amount, load.standard_error, load.sigmas),)
