"""Runs at constant speed, and friction over speed (figures 8 and 9 of the paper)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.identification import FrictionCurve

FAST = 0.15
"""[rad/s] up to which Fig. 9 is drawn, so that the bend at low speed is seen"""


def run_figure(curve: FrictionCurve) -> Figure:
    """One speed of a joint, forth and back: angle, and torque with eq. 73 between (Fig. 8)."""
    point = curve.points[len(curve.points) // 2]
    figure = Figure(figsize=(9.0, 2.8), layout="constrained")
    angle = figure.add_subplot(1, 2, 1)
    torque = figure.add_subplot(1, 2, 2)
    for run, name in ((point.forth, "forth"), (point.back, "back")):
        since = run.time - run.time[0]
        degrees = np.degrees(run.angle)
        angle.plot(since, degrees, label=f"{name}, {run.speed:+.3g} rad/s")
        torque.plot(degrees, run.torque, lw=0.6, label=name)
    torque.axhline(point.level, color="0.4", ls="--", lw=0.8, label="half the sum")
    angle.set(xlabel="time [s]", ylabel=f"angle {curve.joint} [deg]")
    torque.set(xlabel=f"angle {curve.joint} [deg]", ylabel=f"torque {curve.joint} [Nm]")
    for axis in (angle, torque):
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small")
    return figure


def friction_figure(curves: Sequence[FrictionCurve]) -> Figure:
    """Friction of eq. 73 and the law through it, up to `FAST`, a joint a panel (Fig. 9)."""
    rows = (len(curves) + 2) // 3
    figure = Figure(figsize=(9.0, 2.8 * rows), layout="constrained")
    for place, curve in enumerate(curves):
        axis = figure.add_subplot(rows, 3, place + 1)
        shown = [p for p in curve.points if p.speed <= FAST] or list(curve.points)
        speed = np.array([p.speed for p in shown])
        errors = [1.96 * p.error for p in shown]
        friction = [p.torque for p in shown]
        axis.errorbar(speed, friction, errors, fmt=".", color="0.4", ms=4, label="measured")
        dense = np.linspace(0.0, 1.05 * speed.max(), 300)[1:]
        axis.plot(dense, curve.torque(dense), color="tab:blue", lw=1.0, label="law")
        axis.set(xlabel="speed [rad/s]", ylabel=f"friction {curve.joint} [Nm]")
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small")
    return figure


def law_rows(curves: Sequence[FrictionCurve]) -> tuple[list[str], list[list[object]]]:
    """Head and rows as Tab. 5: a joint a row, each number with its 95 % interval."""
    head = ["joint", "F_s [Nm]", "F_c [Nm]", "F_v [Nms/rad]", "omega_st [rad/s]", "speeds"]
    rows: list[list[object]] = []
    for curve in curves:
        told = [
            f"{value:.3g} ± {1.96 * error:.2g}" if np.isfinite(error) else "not shown"
            for value, error in zip(curve.law, curve.errors, strict=True)
        ]
        rows.append([str(curve.joint), *told, str(len(curve.points))])
    return head, rows
