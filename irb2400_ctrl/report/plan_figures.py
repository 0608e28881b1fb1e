"""Figures of a plan: joint angles, singularity margins and torque along the path, against their
limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import Plan
from irb2400_ctrl.report.rotation_figure import rotation_figure

MARGINS = (
    ("wrist", "wrist |sin q5| [-]"),
    ("shoulder", "shoulder |r| [m]"),
    ("elbow", "elbow |k| [m]"),
)

# a figure is 1080 pixels wide
_MOST_ROWS = 2000


def plan_figures(plan: Plan) -> dict[str, Figure]:
    """Caption -> figure."""
    return {
        "Torque of each joint along the motion; the limits are dashed.": torque_figure(plan),
        "Distance from the three singularities; the dashed line is the smallest value over the "
        "whole path.": (margin_figure(plan)),
        "Joint angles along the motion; the ends of the joint box are dashed.": joint_figure(plan),
    }


def save_figures(plan: Plan, out: Path) -> list[Path]:
    """Write torque.png, margins.png, joints.png and, if there is one, the rotation_map.png into a
    folder; returns their paths."""
    figures = dict(zip(("torque", "margins", "joints"), plan_figures(plan).values(), strict=True))
    if plan.rotation_map is not None:
        figures["rotation_map"] = rotation_figure(plan.rotation_map)
    paths = []
    for name, figure in figures.items():
        paths.append(out / f"{name}.png")
        figure.savefig(paths[-1], dpi=120, metadata={"Software": None})
    return paths


def torque_figure(plan: Plan) -> Figure:
    """Torque over time, one plot a joint."""
    limits = plan.certificate.limits.tau_max
    return _joint_plots(plan, plan.tau, -limits, limits, "torque", "Nm")


def joint_figure(plan: Plan) -> Figure:
    """Joint angles over time, one plot a joint."""
    low = np.degrees(plan.robot.q_min)
    high = np.degrees(plan.robot.q_max)
    return _joint_plots(plan, np.degrees(plan.trajectory.q), low, high, "angle", "deg")


def margin_figure(plan: Plan) -> Figure:
    """The three singularity factors over time, with their smallest values over the continuous
    path."""
    figure = _figure(6.0)
    factors = np.abs(Model(plan.robot).singularity_factors(plan.trajectory.q))
    time, shown = _thin(plan.trajectory.time, factors)
    for axis, (name, label), values in zip(
        figure.subplots(3, 1, sharex=True), MARGINS, shown.T, strict=True
    ):
        axis.plot(time, values, lw=1.0)
        axis.axhline(plan.singularity_margin[name], color="tab:red", ls="--", lw=0.9)
        axis.set_ylabel(label)
        axis.set_ylim(bottom=0)
        axis.grid(alpha=0.3)
    axis.set_xlabel("time [s]")
    return figure


def _figure(height: float) -> Figure:
    """Margins stated: working them out from the labels takes longer than drawing."""
    figure = Figure(figsize=(9.0, height))
    figure.subplots_adjust(left=0.09, right=0.985, top=0.98, bottom=0.08, wspace=0.24, hspace=0.14)
    return figure


def _thin(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest of groups of rows, where there are more rows than a figure shows; values
    (m, k)."""
    group = len(time) // _MOST_ROWS
    if group < 2:
        return time, values
    count = len(time) // group * group
    parts = values[:count].reshape(-1, group, values.shape[1])
    both = np.stack([parts.min(axis=1), parts.max(axis=1)], axis=1)
    times = np.repeat(time[:count:group], 2)
    return np.append(times, time[-1]), np.vstack([both.reshape(-1, values.shape[1]), values[-1]])


def _joint_plots(
    plan: Plan, values: np.ndarray, low: np.ndarray, high: np.ndarray, what: str, unit: str
) -> Figure:
    n = values.shape[1]
    time, values = _thin(plan.trajectory.time, values)
    figure = _figure(7.0)
    axes = figure.subplots((n + 1) // 2, 2, sharex=True).ravel()
    for j in range(n):
        axes[j].plot(time, values[:, j], lw=0.9)
        for limit in (low[j], high[j]):
            axes[j].axhline(limit, color="tab:red", ls="--", lw=0.9)
        axes[j].set_ylabel(f"{what} {j + 1} [{unit}]")
        axes[j].grid(alpha=0.3)
    for axis in axes[-2:]:
        axis.set_xlabel("time [s]")
    return figure
