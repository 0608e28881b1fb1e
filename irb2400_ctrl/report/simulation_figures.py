"""Figures of closed-loop simulations."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.simulation import Simulation


def tracking_figure(runs: Mapping[str, Simulation]) -> Figure:
    """Distance of the TCP from its reference over time, one line per run, and the largest error of
    each joint."""
    figure = Figure(figsize=(9.0, 6.2), layout="constrained")
    over_time, per_joint = figure.subplots(2, 1, height_ratios=(3, 2))
    width = 0.8 / len(runs)
    for k, (name, run) in enumerate(runs.items()):
        error = 1e3 * run.tcp_error
        rms = float(np.sqrt(np.mean(error**2)))
        over_time.plot(
            run.time, error, lw=1.0, label=f"{name}: {rms:.3f} mm rms, {error.max():.3f} mm at most"
        )
        worst = np.degrees(np.abs(run.q - run.q_ref)).max(axis=0)
        per_joint.bar(
            np.arange(1, len(worst) + 1) + (k - (len(runs) - 1) / 2) * width,
            worst,
            width,
            label=name,
        )
    over_time.set(xlabel="time [s]", ylabel="TCP error [mm]")
    over_time.set_ylim(bottom=0)
    over_time.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False)
    over_time.grid(alpha=0.3)
    per_joint.set(xlabel="joint", ylabel="largest joint error [deg]")
    per_joint.set_yscale("log")
    per_joint.grid(alpha=0.3, axis="y")
    return figure


def torque_figure(run: Simulation, name: str) -> Figure:
    """Torque of every joint over time against its limits."""
    n = run.tau.shape[1]
    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    axes = figure.subplots((n + 1) // 2, 2, sharex=True).ravel()
    for joint, (axis, limit) in enumerate(zip(axes, run.plant.tau_bound, strict=False)):
        axis.plot(run.time, run.tau[:, joint], lw=0.8)
        for sign in (-1, 1):
            axis.axhline(
                sign * limit if np.isfinite(limit) else np.nan, color="tab:red", lw=0.9, ls="--"
            )
        axis.set_ylabel(f"torque {joint + 1} [Nm]")
        axis.grid(alpha=0.3)
    for axis in axes[-2:]:
        axis.set_xlabel("time [s]")
    figure.suptitle(f"{name}: torque and limits (dashed)")
    return figure
