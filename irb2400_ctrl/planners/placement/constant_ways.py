"""All ways through a task with a constant tool rotation, looked at together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.joint_box import left_in_box
from irb2400_ctrl.planners.redundancy.ladder_graph import BOX_INSET
from irb2400_ctrl.planners.redundancy.ladder_moves import LARGEST_STEP
from irb2400_ctrl.planners.redundancy.singularity_margins import reach_left, relative_margins

_TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Ways:
    """Continuous ways within the joint box, w of them."""

    q: Array
    """whole turns included, those that bring the motion to the middle of the joint box [rad], shape
    (w, n, joints)"""
    kinematic: dict[str, Array]
    """smallest of the margins that need no forces, shape (w,)"""
    time: Array
    """that the joints need at full speed [s], shape (w,)"""


def constant_ways(model: Model, base: Array) -> Ways:
    """Those that are continuous and inside the joint box.

    Args:
        base: closed-form configurations of n stations, r rotations and 8 branches in (-pi, pi],
            shape (n, r, 8, joints).
    """
    n, _, _, joints = base.shape
    robot = model.robot
    q = base.reshape(n, -1, joints)
    q = q[:, np.isfinite(q).all(axis=(0, 2))]
    q = np.unwrap(q, axis=0)
    q = q[:, (np.abs(np.diff(q, axis=0)) < LARGEST_STEP).all(axis=(0, 2))]
    centre = (robot.q_min + robot.q_max) / 2
    q = q + _TURN * np.round((centre - (q.min(axis=0) + q.max(axis=0)) / 2) / _TURN)
    box = left_in_box(robot, q).min(axis=0, initial=np.inf)
    inside = box > BOX_INSET
    q = np.ascontiguousarray(q[:, inside].transpose(1, 0, 2))
    if not len(q):
        none = np.empty(0)
        nothing = {"singularity": none, "joint_limits_deg": none, "reach_mm": none}
        return Ways(q, nothing, none)
    flat = q.reshape(-1, joints)
    margin = relative_margins(model, flat).min(axis=1).reshape(len(q), n)
    return Ways(
        q,
        {
            "singularity": margin.min(axis=1),
            "joint_limits_deg": np.degrees(box[inside]),
            "reach_mm": 1e3 * reach_left(model, q).min(axis=1),
        },
        (np.abs(np.diff(q, axis=1)) / robot.qd_max).max(axis=2).sum(axis=1),
    )
