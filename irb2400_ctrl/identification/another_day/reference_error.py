"""What a reference leaves unexplained itself: below that nothing is said to have changed.

A model of a real arm is never complete. S_j^2 = RMSE_j^2 - floor_j^2 is what it leaves on joint j
beyond noise; on stretches of the reference that the fit had not seen it is what the model is worth,
and today's log has to show more than that before anything has changed.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis import Diagnosis, Number
from irb2400_ctrl.diagnosis.numbers import FRICTION, RATIO
from irb2400_ctrl.diagnosis.preparation.metrics import beyond_noise, noise_floor
from irb2400_ctrl.identification.identification import Identification

WORSE = 1.3
"""today's S over the reference's, from which on a joint says that something changed"""
LEAST = 0.1
"""of the noise floor: an S below that is not told from none"""


def unseen_error(known: Identification, floor: Array | None = None) -> Array:
    """RMSE on unseen stretches of the reference log that is worst on each joint, (n,) [Nm].

    What one motion of that day leaves, another may leave today. An identification may smooth noisy
    angles more strongly than a diagnosis does: what today's noise is more than that of a reference
    log, as the fit saw it, is no more than usual either.

    Args:
        known: of the reference; floor: noise of today's log [Nm], (n,).
    """
    each = []
    for log in known.logs:
        unseen = log.error("unseen").rmse
        if floor is not None:
            step = float(np.median(np.diff(log.time)))
            then = noise_floor(log.measured - log.fitted, log.known, step)
            unseen = np.hypot(unseen, beyond_noise(floor, then))
        each.append(unseen)
    return np.asarray(np.max(each, axis=0))


def worse_joints(error: Array, floor: Array, before: Diagnosis, unseen: Array) -> Mask:
    """Joints on which an error of today's log is more than what the reference leaves, (n,).

    Args:
        error, floor: RMSE and noise floor of today [Nm]; before: of the reference; unseen: its
            error on unseen stretches.
    """
    least = LEAST * before.least_floor
    usual = np.maximum(beyond_noise(unseen, before.least_floor), least)
    return np.asarray(beyond_noise(error, floor) > WORSE * usual)


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


def has_changed(number: Number, worse: Mask, told: Collection[str] = ()) -> bool:
    """Whether a number is that of a joint, or a body, which today's log shows otherwise.

    Args:
        number: of the reference, and of today; worse: as `worse_joints`.
        told: joints whose friction as a whole is told from the reference's along the motion: sample
            by sample it need not be more than what the reference leaves.
    """
    if number.place in told and number.name in (*FRICTION, RATIO):
        return True
    where, _, place = number.place.partition(" ")
    return bool(worse[int(place) - 1]) if where == "joint" else bool(worse.any())
