"""Way-points in joint space: what is wrong with them, and on which side of the singularities they
lie."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import numbers
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.joint_box import can_hold, inside_box
from irb2400_ctrl.planners.redundancy.singularity_margins import NAMES


def checked_waypoints(model: Model, waypoints: ArrayLike) -> Array:
    """The way-points as an array (k, n): k > 1, inside the joint box, light enough to hold, no two
    alike in a row."""
    W = numbers("waypoints", waypoints)
    if W.ndim != 2 or W.shape[0] < 2 or W.shape[1] != model.robot.n or not np.isfinite(W).all():
        raise InputError(
            f"waypoints of shape {W.shape}, expected two or more finite rows of {model.robot.n} "
            "angles [rad]"
        )
    for k, q in enumerate(W):
        inside_box(model, f"way-point {k + 1}", q)
        can_hold(model, f"way-point {k + 1}", q)
    same = np.flatnonzero(np.abs(np.diff(W, axis=0)).max(axis=1) < 1e-6)
    if len(same):
        raise InputError(
            f"way-points {same[0] + 1} and {same[0] + 2} are the same; leave one of them out"
        )
    return W


def signed_margins(
    model: Model, W: Array, margins: Mapping[str, float]
) -> tuple[tuple[int, float], ...]:
    """(number of the factor, bound with the sign that it has at the way-points)."""
    unknown = set(margins) - set(NAMES)
    if unknown or any(not (np.isfinite(v) and v > 0) for v in margins.values()):
        raise InputError(
            f"margins {dict(margins)}, expected positive numbers for some of {', '.join(NAMES)}"
        )
    if not margins:
        return ()
    factors = (
        np.asarray(model.function("singularity_factors").map(len(W))(W.T)).reshape(-1, len(W)).T
    )
    found = []
    for name, least in margins.items():
        k = NAMES.index(name)
        sign = np.sign(factors[0, k])
        wrong = np.flatnonzero(sign * factors[:, k] < least)
        if len(wrong):
            raise InputError(
                f"way-point {wrong[0] + 1}: the {name} factor is {factors[wrong[0], k]:.4g}, "
                "expected at least "
                f"{least:.4g} on the side of way-point 1 ({factors[0, k]:.4g}); lower the margin "
                "or move the way-point"
            )
        found.append((k, float(sign * least)))
    return tuple(found)
