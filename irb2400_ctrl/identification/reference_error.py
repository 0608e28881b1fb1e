"""What a reference leaves unexplained itself: below that nothing is said to have changed.

A model of a real arm is never complete. S_j^2 = RMSE_j^2 - floor_j^2 is what it leaves on joint j
beyond noise; on stretches of the reference that the fit had not seen it is what the model is worth,
and today's log has to show more than that before anything has changed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis import Diagnosis, Number
from irb2400_ctrl.identification.identification import Identification

WORSE = 1.3
"""today's S over the reference's, from which on a joint says that something changed"""
LEAST = 0.1
"""of the noise floor: an S below that is not told from none"""


def unseen_error(known: Identification) -> Array:
    """RMSE on unseen stretches of the reference log that is worst on each joint, (n,) [Nm].

    What one motion of that day leaves, another may leave today.
    """
    return np.asarray(np.max([log.error("unseen").rmse for log in known.logs], axis=0))


def worse_joints(error: Array, floor: Array, before: Diagnosis, unseen: Array) -> Mask:
    """Joints on which an error of today's log is more than what the reference leaves, (n,).

    Args:
        error, floor: RMSE and noise floor of today [Nm]; before: of the reference; unseen: its
            error on unseen stretches.
    """
    least = LEAST * before.least_floor
    usual = np.maximum(_beyond(unseen, before.least_floor), least)
    return np.asarray(_beyond(error, floor) > WORSE * usual)


def simplest(
    found: Diagnosis, few: Callable[[int], Diagnosis], before: Diagnosis, unseen: Array
) -> Diagnosis:
    """The fewest changes with which today's log is explained as well as the reference was.

    Args:
        few: the diagnosis with at most so many explanations.
    """
    # a floor that is read from what few explanations leave holds what they leave out
    floor = found.least_floor
    said = len(found.findings) + len(found.unexplained)
    for count in range(said):
        tried = few(count)
        after = tried.identification.error_after.rmse
        if not worse_joints(after, floor, before, unseen).any():
            left = "smaller explanations are within what the reference leaves unexplained itself"
            return replace(tried, weak=(*tried.weak, f"{said - count} {left}"))
    return found


def has_changed(number: Number, worse: Mask) -> bool:
    """Whether a number is that of a joint, or a body, which today's log shows otherwise."""
    where, _, place = number.place.partition(" ")
    return bool(worse[int(place) - 1]) if where == "joint" else bool(worse.any())


def _beyond(error: Array, floor: Array) -> Array:
    return np.sqrt(np.maximum(error**2 - floor**2, 0.0))
