"""Figure of an excitation: angles and torques against their limits, and the separability before and
after."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.excitation.pair_separability import CLEAR, Separability
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

MOST = 24
"""pairs that are drawn; the least separated ones"""


def motion_figure(
    robot: Robot, course: Trajectory, tau: Array, table: Sequence[Separability], name: str
) -> Figure:
    """Angles and torques as shares of their limits, and one pair of bars for each two effects.

    Args:
        robot: whose limits.
        course: the motion.
        tau: torque of the model along it [Nm], shape (m, n).
        table: the pairs; those that no motion separates are left out.
        name: of the group, for the title.
    """
    rows = sorted((r for r in table if not r.hopeless), key=lambda r: r.distance[1])[:MOST]
    figure = Figure(figsize=(9.0, 6.5 + 0.22 * len(rows)), layout="constrained")
    ratios = [1.0, 1.0, max(0.6, 0.09 * len(rows))]
    angle, torque, bars = figure.subplots(3, 1, gridspec_kw={"height_ratios": ratios})
    middle = (robot.q_max + robot.q_min) / 2
    half = (robot.q_max - robot.q_min) / 2
    for axis, values, label in (
        (angle, (course.q - middle) / half, "angle over half range [-]"),
        (torque, tau / robot.tau_max, "torque over limit [-]"),
    ):
        for j in range(robot.n):
            axis.plot(course.time, values[:, j], lw=0.9, label=f"axis {j + 1}")
        for limit in (-1.0, 1.0):
            axis.axhline(limit, color="tab:red", ls="--", lw=0.9)
        axis.set_ylabel(label)
        axis.set_xlabel("time [s]")
        axis.grid(alpha=0.3)
    angle.legend(ncols=robot.n, fontsize="small", loc="upper center")
    place = np.arange(len(rows))
    bars.barh(
        place + 0.2,
        [max(r.distance[0], 1e-2) for r in rows],
        0.4,
        color="tab:gray",
        label="standard motion",
    )
    bars.barh(
        place - 0.2,
        [max(r.distance[1], 1e-2) for r in rows],
        0.4,
        color="tab:blue",
        label="this motion",
    )
    bars.axvline(CLEAR, color="tab:red", ls="--", lw=0.9)
    bars.set_yticks(place, [r.pair for r in rows], fontsize="small")
    bars.set_xscale("log")
    bars.set_xlabel("separation [standard deviations of the assumed noise]")
    if rows:
        bars.legend(fontsize="small")
    figure.suptitle(f"Motion that separates: {name}")
    return figure
