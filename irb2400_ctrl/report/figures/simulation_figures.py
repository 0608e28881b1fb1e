"""Figures of closed-loop simulations."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.report.elements.plots import Line, joint_plots, logarithmic, thin, wide
from irb2400_ctrl.simulation import Simulation


def tracking_figure(runs: Mapping[str, Simulation]) -> Figure:
    """Distance of the TCP from its reference over time, one line per run."""
    figure, axis = wide(3.4)
    for name, run in runs.items():
        error = 1e3 * run.tcp_error
        rms = float(np.sqrt(np.mean(error**2)))
        time, shown = thin(run.time, error)
        label = f"{name}: {rms:.3f} mm rms, {error.max():.3f} mm at most"
        axis.plot(time, shown, lw=1.0, label=label)
    axis.set(xlabel="time [s]", ylabel="TCP error [mm]", xlim=(run.time[0], run.time[-1]))
    axis.set_ylim(bottom=0)
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False)
    return figure


def joint_figure(runs: Mapping[str, Simulation]) -> Figure:
    """Largest error of each joint, one bar per run."""
    figure, axis = wide(2.6)
    width = 0.8 / len(runs)
    for k, (name, run) in enumerate(runs.items()):
        worst = np.degrees(np.abs(run.q - run.q_ref)).max(axis=0)
        place = np.arange(1, len(worst) + 1) + (k - (len(runs) - 1) / 2) * width
        axis.bar(place, worst, width, label=name)
    axis.set(xlabel="joint", ylabel="largest error [deg]")
    logarithmic(axis, "y")
    if len(runs) > 1:
        axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False, ncols=len(runs))
    return figure


def torque_figures(run: Simulation) -> list[Figure]:
    """Torque of every joint over time against its limits."""
    limit = run.plant.tau_bound
    return joint_plots(
        run.time, [Line(run.tau, width=0.8)], "torque {joint} [Nm]", limits=(-limit, limit)
    )


def error_figures(run: Simulation) -> list[Figure]:
    """Angle less reference of every joint over time."""
    error = 1e3 * np.degrees(run.q - run.q_ref)
    return joint_plots(run.time, [Line(error, width=0.8)], "error {joint} [mdeg]")
