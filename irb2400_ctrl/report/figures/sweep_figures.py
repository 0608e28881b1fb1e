"""Figures of a sweep: how the TCP error spreads over the plants, controller by controller."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.report.elements.plots import logarithmic, wide
from irb2400_ctrl.sweep.table import SummaryLine

SHARES = (0.05, 0.5, 0.95)


def share_figure(lines: Sequence[SummaryLine]) -> Figure:
    """Share of all runs below an error, one curve per controller."""
    figure, axis = wide(3.8)
    for controller in dict.fromkeys(line.controller for line in lines):
        own = [line for line in lines if line.controller == controller]
        errors = np.sort([e for line in own for e in line.errors_mm])
        total = len(errors) + sum(line.failed for line in own)
        # runs that failed never come below any error: the curve ends lower than 1
        height = np.arange(1, len(errors) + 1) / total
        axis.step(errors, height, where="post", label=controller)
    axis.set(xlabel="rms TCP error of a run [mm]", ylabel="share of runs below [-]", ylim=(0, 1.02))
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False, ncols=3)
    if any(line.errors_mm for line in lines):
        logarithmic(axis, "x")
    return figure


def motion_figure(lines: Sequence[SummaryLine]) -> Figure:
    """Median and 5 to 95 % of the error, motion by motion."""
    controllers = list(dict.fromkeys(line.controller for line in lines))
    motions = list(dict.fromkeys((line.motion, line.speed) for line in lines))
    figure, axis = wide(1.2 + 0.2 * len(motions) * (len(controllers) + 1))
    height = len(controllers) + 1.0
    for line in lines:
        if not line.errors_mm:
            continue
        motion = motions.index((line.motion, line.speed))
        own = controllers.index(line.controller)
        place = height * motion + own
        smallest, middle, largest = (line.quantile(share) for share in SHARES)
        axis.plot([smallest, largest], [place, place], lw=3, alpha=0.4, c=f"C{own % 10}")
        axis.plot(middle, place, "o", ms=5, c=f"C{own % 10}")
    ticks = [height * k + (len(controllers) - 1) / 2 for k in range(len(motions))]
    axis.set_yticks(ticks, [f"{motion}\nspeed {speed:g}" for motion, speed in motions])
    axis.set_ylim(height * len(motions) - 1.5, -0.5)  # the first on top, room at both ends
    axis.set_xlabel("rms TCP error of a run [mm]: median, 5 to 95 %")
    if any(line.errors_mm for line in lines):
        logarithmic(axis, "x")
    return figure
