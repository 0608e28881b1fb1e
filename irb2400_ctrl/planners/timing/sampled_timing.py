"""Timing with effects whose torque has no bound: sampled, with room to spare.

The torque of a link that swings behind its motor follows the second derivative of the load. The
timing lets the acceleration jump, so that there is none; what is sampled is the model's slow
twist, and the swing is left out.
"""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.planners.enclosure.cells import Cells
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.time_optimal import time_path

_ROUNDS = 6
_SAMPLES = 5
# held back beyond what the samples show, as a part of it
_ROOM = 0.03


def time_with_samples(
    dynamics: PathDynamics,
    path: JointPath,
    cells: Cells,
    limits: MotionLimits,
    friction: Array,
    feed: Array,
) -> PiecewiseConstantLaw:
    """Time the path, sample the extra torque along the motion, hold that much back, and time it
    again.

    Raises:
        InfeasibleError: nothing is left of the limits, or the rounds do not settle.
    """
    held = np.zeros((len(cells.h), 2, path.n))
    law: PiecewiseConstantLaw | None = None
    for _ in range(_ROUNDS):
        law = time_path(cells, limits, friction, feed, held)
        extra = _largest_extra(dynamics, path, law)
        if (extra <= held + 1e-9).all():
            return law
        # only ever more: the rounds end
        held = np.maximum(held, extra + _ROOM * np.abs(extra) + 1e-6)
    raise InfeasibleError(
        "the torque of the effects "
        + ", ".join(sorted({e.kind for e in dynamics.irregular}))
        + " does not settle with the timing "
        f"({'no motion' if law is None else f'{law.duration:.2f} s'} at last); "
        "lower the speed limits"
    )


def guarantee_note(dynamics: PathDynamics, certified: bool, holds: bool) -> str:
    """Why a plan's torque bound is not guaranteed; empty where it is.

    Args:
        dynamics: the arm's torque along the path.
        certified: whether the law itself was bounded.
        holds: whether the bounds are inside the limits.
    """
    if not certified:
        return (
            "timing by toppra: the torque limits are kept at grid points, in between they were "
            "only looked at"
        )
    if dynamics.irregular:
        return "; ".join(_without_bound(effect) for effect in dynamics.irregular)
    if holds:
        return ""
    return (
        "the check of the bound failed; plan with another tolerance (--tolerance-mm) or a lower "
        "feed, or in Python with more cells (cells=)"
    )


def _without_bound(effect: Effect) -> str:
    name = effect.kind if effect.joint is None else f"{effect.kind} on axis {effect.joint}"
    held = f"was looked at and held back with {100 * _ROOM:.0f} % to spare"
    if effect.acts == "transmission":
        return (
            f"{name}: the link swings behind its motor where the acceleration jumps, and what "
            f"that adds has no bound; its slow part {held}"
        )
    return f"{name}: no bound of its torque between the points is known; it {held}"


def _largest_extra(dynamics: PathDynamics, path: JointPath, law: PiecewiseConstantLaw) -> Array:
    """Largest extra torque upwards and downwards in each cell and its neighbours, shape (m, 2,
    n)."""
    m = len(law.u)
    part = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    t = (law.time[:-1, None] + part * np.diff(law.time)[:, None]).ravel()
    _, q, qd, qdd = law.motion(path, t)
    tau = dynamics.irregular_torque(q, qd, qdd, t).reshape(m, _SAMPLES, path.n)
    both = np.stack([tau.max(axis=1), -tau.min(axis=1)], axis=1)
    padded = np.pad(both, ((1, 1), (0, 0), (0, 0)), mode="edge")
    return np.asarray(np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:]))
