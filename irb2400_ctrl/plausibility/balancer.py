"""A balancer that no file states: a URDF has masses, and no spring that carries them."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.plausibility.criteria import explained_beside
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.rows import Rows

JOINTS = (2, 3)
"""from 1: those that carry an arm's weight"""


def beside_a_balancer(nominal: Nominal, rows: Rows, best: Fit) -> tuple[Fit, str] | None:
    """How a log as labelled is explained beside a balancer on joint 2 or 3, and what is said of it;
    None where that is not clearly better than the best other reading, or does not fit.

    Args:
        nominal: the robot as a yardstick; rows: of the log as labelled.
        best: what other readings come to.
    """
    n = nominal.robot.n
    columns = nominal.columns(rows)
    fits = {
        joint: nominal.account(rows, columns, _springs(rows, joint - 1)).fit
        for joint in JOINTS
        if joint <= n
    }
    if not fits:
        return None
    joint = min(fits, key=lambda j: fits[j].cost)
    found = fits[joint]
    if not explained_beside(found, best):
        return None
    says = (
        f"the model explains the torques beside a balancer on joint {joint}, which the robot file "
        "does not have; `irb2400 identify` and `irb2400 diagnose` look for it"
    )
    return found, says


def _springs(rows: Rows, j: int) -> Array:
    """Torques on one joint (from 0) as large as those that were recorded, over its angle,
    (m, n, 2) [Nm]."""
    found = np.zeros((*rows.tau.shape, 2))
    found[:, j, 0] = rows.size[j] * np.sin(rows.q[:, j])
    found[:, j, 1] = rows.size[j] * np.cos(rows.q[:, j])
    return found
