"""Gears of a wrist that no file states: an axis that moves turns the motors of the others."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.plausibility.criteria import explained_beside
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.reading import ORDERS, motion_readings, torque_readings
from irb2400_ctrl.plausibility.rows import CREEP, Rows

FIRST = 4
"""joint (from 1) that a wrist begins with"""
FURTHEST = 2
"""axes further, to which a shaft through a wrist goes"""
MIXED_UP = (*ORDERS, "torque_sign", "angle_sign")
"""readings that such gears explain as well: what one axis does shows in the torque of another"""
SHARE = 0.3
"""standard deviation of what another axis gives a joint, of the joint's torque"""


def beside_a_coupled_wrist(nominal: Nominal, rows: Rows, best: Fit) -> tuple[Fit, str] | None:
    """How a log as labelled is explained beside gears between the axes of the wrist, and what is
    said of it; None where that is not clearly better than the best other reading, or does not fit.

    Args:
        nominal: the robot as a yardstick; rows: of the log as labelled.
        best: what other readings come to.
    """
    robot = nominal.robot
    if robot.n <= FIRST:
        return None
    found = _fit(nominal, rows)
    if not explained_beside(found, best):
        return None
    readings = (*torque_readings(robot), *motion_readings(robot))
    mixed_up = (r for r in readings if r.kind in MIXED_UP and min(r.joints, default=0) >= FIRST)
    if any(_fit(nominal, rows.read_as(r)).cost < found.cost for r in mixed_up):
        return None
    says = (
        "the model explains the torques beside gears of the wrist, whose axes turn each other's "
        "motors, which the robot file does not have; `irb2400 identify` and `irb2400 diagnose` "
        "look for them"
    )
    return found, says


def of_other_axes(rows: Rows) -> Array:
    """Torques per standard deviation of what the axes of the wrist may give each other's motors,
    (m, n, k) [Nm]; none of an arm without a wrist."""
    axes = range(FIRST - 1, rows.tau.shape[1])
    pairs = [(j, k) for j in axes for k in axes if 0 < abs(j - k) <= FURTHEST]
    none = np.zeros((*rows.tau.shape, 0))
    return np.concatenate([none, *(_of_the_other(rows, *pair) for pair in pairs)], axis=2)


def _fit(nominal: Nominal, rows: Rows) -> Fit:
    """How rows are explained beside such gears."""
    return nominal.account(rows, nominal.columns(rows), of_other_axes(rows)).fit


def _of_the_other(rows: Rows, j: int, k: int) -> Array:
    """Torques on joint j by the motion of joint k (from 0): friction and inertia of a motor that k
    alone turns, and dry friction of one that both turn, one way or the other, (m, n, 5) [Nm]."""
    both = [np.tanh((rows.qd[:, k] + way * rows.qd[:, j]) / CREEP) for way in (1.0, -1.0)]
    signals = np.column_stack([rows.turn[:, k], rows.qd[:, k], rows.qdd[:, k], *both])
    size = np.sqrt(np.mean(signals**2, axis=0))
    found = np.zeros((*rows.tau.shape, signals.shape[1]))
    found[:, j] = SHARE * rows.size[j] * signals / np.where(size > 0.0, size, 1.0)
    return found
