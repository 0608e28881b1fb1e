"""What a reference leaves unexplained itself: below that nothing is said to have changed.

A model of a real arm is never complete. S_j^2 = RMSE_j^2 - floor_j^2 is what it leaves on joint j
beyond noise; on stretches of the reference that the fit had not seen it is what the model is worth,
and today's log has to show more than that before anything has changed.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis import Diagnosis, Finding, Number
from irb2400_ctrl.identification.identification import Identification

WORSE = 1.3
"""today's S over the reference's, from which on a joint says that something changed"""
LEAST = 0.1
"""of the noise floor: an S below that is not told from none"""
FELT = 0.5
"""of an effect's largest share, which makes a joint one of its own"""


def unseen_error(known: Identification) -> Array:
    """RMSE on unseen stretches of the reference logs, (n,) [Nm]."""
    squares = [log.error("unseen").rmse ** 2 for log in known.logs]
    return np.asarray(np.sqrt(np.mean(squares, axis=0)))


def worse_joints(found: Diagnosis, before: Diagnosis, unseen: Array) -> Mask:
    """Joints on which today's log shows more than the reference leaves, (n,)."""
    least = LEAST * before.noise_floor
    usual = np.maximum(_beyond(unseen, before.noise_floor), least)
    today = _beyond(found.identification.error_before.rmse, found.noise_floor)
    return np.asarray(today > WORSE * usual)


def changes(found: Diagnosis, worse: Mask) -> int:
    """How many of the explanations act on such a joint."""
    named = sum(bool(worse[_own_joints(finding)].any()) for finding in found.findings)
    return named + sum(bool(worse[rest.joint - 1]) for rest in found.unexplained)


def has_changed(number: Number, worse: Mask) -> bool:
    """Whether a number is that of a joint, or a body, which today's log shows otherwise."""
    where, _, place = number.place.partition(" ")
    return bool(worse[int(place) - 1]) if where == "joint" else bool(worse.any())


def _own_joints(finding: Finding) -> Mask:
    return np.asarray(finding.share >= FELT * finding.share.max())


def _beyond(error: Array, floor: Array) -> Array:
    return np.sqrt(np.maximum(error**2 - floor**2, 0.0))
