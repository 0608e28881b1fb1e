"""What a planned excitation asks of each joint: shares of its limits, and all of it over time."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.excitation.acceleration import AccelerationLimits
from irb2400_ctrl.report.elements.page import Page, sentence
from irb2400_ctrl.report.figures import plan_figures as draw
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

KEPT_RANGE = (
    "Angles; ends of the range that is kept are dashed (a part of the joint's where the arm needs "
    "room)."
)


def add_joints(page: Page, robot: Robot, motion: Trajectory) -> None:
    """Table and figures, under the heading that the page has.

    Args:
        page: that they are added to.
        robot: whose limits are shown.
        motion: with its torque.
    """
    limits = AccelerationLimits.of(robot)
    page.table("Largest values over the rows of the file", *joint_rows(robot, motion))
    if limits.assumed:
        page.finding(sentence(limits.remark()))
    page.figures(draw.angle_figures(motion, robot), KEPT_RANGE, True)
    page.figures(draw.speed_figures(motion, robot), "Speed; limits are dashed.", True)
    bends = draw.acceleration_figures(motion, limits.values)
    page.figures(bends, "Acceleration; limits are dashed.", True)
    torques = draw.torque_figures(motion, robot.tau_max)
    page.figures(torques, "Torque; limits are dashed.", True)


def joint_rows(robot: Robot, motion: Trajectory) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a joint a row, the torque of `motion` known."""
    assert motion.tau is not None
    limits = AccelerationLimits.of(robot)
    head = ["joint", "range [deg]", "speed [deg/s]", "acceleration [deg/s²]", "torque [Nm]"]
    rows: list[list[object]] = []
    for j in range(robot.n):
        low, high = np.degrees([motion.q[:, j].min(), motion.q[:, j].max()])
        stated = "assumed " if j + 1 in limits.assumed else ""
        rows.append(
            [
                str(j + 1),
                f"{low:.0f} to {high:.0f}",
                _of(np.degrees(motion.qd[:, j]), float(np.degrees(robot.qd_max[j]))),
                _of(np.degrees(motion.qdd[:, j]), float(np.degrees(limits.values[j])), stated),
                _of(motion.tau[:, j], float(robot.tau_max[j])),
            ]
        )
    return head, rows


def _of(values: Array, limit: float, kind: str = "") -> str:
    """`96 of 120 (80 %)`."""
    most = float(np.abs(values).max())
    return f"{most:.4g} of {kind}{limit:.4g} ({100 * most / limit:.0f} %)"
