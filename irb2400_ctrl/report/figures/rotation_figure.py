"""The map of tool rotations along a path, with the chosen line on it."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from irb2400_ctrl.planners.redundancy.rotation_map import LIMITS, RotationMap

COLOURS = ("none", "0.85", "0.61", "firebrick", "0.1", "mediumorchid", "darkorange")
"""of `LIMITS`; where nothing is met the margin shows. None is of those that a page changes: the map
is an image, whose colours stay, and its legend is not"""


def rotation_figure(found: RotationMap) -> Figure:
    """Path length against tool rotation, coloured by the worst margin and by what is met."""
    figure = Figure(figsize=(9.0, 5.0))
    figure.subplots_adjust(left=0.09, right=0.99, top=0.88, bottom=0.11)
    axes = figure.subplots()
    way = 1e3 * found.way
    degrees = np.degrees(found.rotation)
    free = np.where(found.limit == 0, found.worth, np.nan)
    shown = axes.pcolormesh(
        way, degrees, free.T, shading="nearest", cmap="viridis", vmin=0, vmax=1, rasterized=True
    )
    met = np.ma.masked_equal(found.limit, 0)
    axes.pcolormesh(
        way, degrees, met.T, shading="nearest", cmap=ListedColormap(COLOURS), vmin=-0.5,
        vmax=len(LIMITS) - 0.5, rasterized=True,
    )  # fmt: skip
    line = np.degrees(found.chosen) % 360
    # not drawn across the whole map where it passes a full turn
    line = np.where(np.abs(np.diff(line, prepend=line[0])) > 180, np.nan, line)
    axes.plot(way, line, color="white", lw=3.2)
    axes.plot(way, line, color="tab:blue", lw=1.6, label="chosen")
    figure.colorbar(shown, ax=axes, label="worst margin, 1 is comfortable", pad=0.02)
    numbers = [k for k in range(1, len(LIMITS)) if (found.limit == k).any()]
    patches = [Patch(color=COLOURS[k], label=LIMITS[k]) for k in numbers]
    lines, _ = axes.get_legend_handles_labels()
    axes.legend(
        handles=[*lines, *patches], loc="lower left", bbox_to_anchor=(0, 1.0), ncols=4, fontsize=8
    )
    axes.set_xlabel("way along the path [mm]")
    axes.set_ylabel("tool rotation [deg]")
    return figure
