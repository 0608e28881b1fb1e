"""Figure of a sweep: how the TCP error spreads over the plants, controller by controller."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from irb2400_ctrl.sweep.table import SummaryLine

SHARES = (0.05, 0.5, 0.95)


def sweep_figure(name: str, lines: Sequence[SummaryLine]) -> Figure:
    """Left: share of all runs below an error, one curve per controller. Right: median and 5 to 95 %
    per motion."""
    controllers = list(dict.fromkeys(line.controller for line in lines))
    motions = list(dict.fromkeys((line.motion, line.speed) for line in lines))
    colours = {controller: f"C{k % 10}" for k, controller in enumerate(controllers)}
    figure = Figure(
        figsize=(12.0, max(5.2, 2.2 + 0.16 * len(motions) * (len(controllers) + 1))),
        layout="constrained",
    )
    left, right = figure.subplots(1, 2, sharex=True)
    figure.suptitle(f"{name}: TCP error over the drawn plants")
    for controller in controllers:
        own = [line for line in lines if line.controller == controller]
        errors = np.sort([e for line in own for e in line.errors_mm])
        total = len(errors) + sum(line.failed for line in own)
        # runs that failed never come below any error: the curve ends lower than 1
        left.step(
            errors,
            np.arange(1, len(errors) + 1) / total,
            where="post",
            c=colours[controller],
            label=controller,
        )
    left.set(xlabel="rms TCP error of a run [mm]", ylabel="share of runs below [-]", ylim=(0, 1.02))
    figure.legend(loc="outside lower center", ncols=min(len(controllers), 4))
    height = len(controllers) + 1.0
    for line in lines:
        if not line.errors_mm:
            continue
        place = height * motions.index((line.motion, line.speed)) + controllers.index(
            line.controller
        )
        smallest, middle, largest = (line.quantile(share) for share in SHARES)
        right.plot([smallest, largest], [place, place], lw=3, alpha=0.4, c=colours[line.controller])
        right.plot(middle, place, "o", ms=5, c=colours[line.controller])
    ticks = [height * k + (len(controllers) - 1) / 2 for k in range(len(motions))]
    right.set_yticks(ticks, [f"{motion}\nspeed {speed:g}" for motion, speed in motions])
    right.invert_yaxis()
    right.set_xlabel("rms TCP error of a run [mm]: median, 5 to 95 %")
    if any(line.errors_mm for line in lines):
        left.set_xscale("log")
        low, high = left.get_xlim()
        # over a decade or two, 1-2-5 reads better than powers of ten; with more there would be no
        # room
        steps = (1.0, 2.0, 5.0) if high / low < 300 else (1.0,)
        left.xaxis.set_major_locator(LogLocator(subs=steps))
        left.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        left.xaxis.set_minor_formatter(NullFormatter())
    for axis in (left, right):
        axis.grid(alpha=0.3, which="both", axis="x")
    left.grid(alpha=0.3, axis="y")
    return figure
