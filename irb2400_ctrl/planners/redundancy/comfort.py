"""Margins of a configuration on a tool path, and from where on more of each is worth nothing."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.clearance.room import COMFORTABLE_CLEARANCE
from irb2400_ctrl.planners.redundancy.singularity_margins import COMFORTABLE

COMFORTABLE_MARGINS = {
    "singularity": COMFORTABLE,
    "joint_limits_deg": 20.0,
    "reach_mm": 100.0,
    "torque_left": 0.3,
    "feed_kept": 1.0,
    "clearance_mm": 1e3 * COMFORTABLE_CLEARANCE,
}
"""unit in the name; parts without one"""


def comfortable(name: str) -> float:
    """From where on more of a margin is worth nothing; of one singularity as of all."""
    return COMFORTABLE_MARGINS.get(name, COMFORTABLE)


def part_of_comfort(name: str, value: Array) -> Array:
    """A margin as a part of what is comfortable, at most 1."""
    return np.minimum(value / COMFORTABLE_MARGINS[name], 1.0)


def middled(model: Model, q: Array) -> Array:
    """The same configurations (..., n) with the whole turns that are nearest to the middle of the
    joint box."""
    turn = 2 * np.pi
    centre = (model.robot.q_min + model.robot.q_max) / 2
    return np.asarray(q + turn * np.round((centre - q) / turn))


def feed_and_torque(model: Model, q: Array, rate: Array) -> tuple[Array, Array]:
    """(feed_kept, torque_left) at q with the joint speeds that the feed asks for [rad/s], both
    (m, n): part of the feed that the joints' speeds allow, and part of the torque limits that is
    left at that speed, accelerations left aside; shapes (m,)."""
    robot = model.robot
    fastest = (np.abs(rate) / robot.qd_max).max(axis=1)
    kept = 1.0 / np.maximum(fastest, 1.0)
    tau = model.inverse_dynamics(q, kept[:, None] * rate, np.zeros_like(rate))
    return kept, 1.0 - (np.abs(tau) / robot.tau_max).max(axis=1)
