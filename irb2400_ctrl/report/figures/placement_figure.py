"""Where a part may stand: the map of a search, and its margins before and after."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.placement import Outlook, Placement, RailPosition
from irb2400_ctrl.planners.redundancy.comfort import COMFORTABLE_MARGINS
from irb2400_ctrl.report.elements.plots import small

NAMES = {
    "singularity": "distance from singularities [-]",
    "joint_limits_deg": "room to the joint limits [deg]",
    "reach_mm": "room to the end of the reach [mm]",
    "torque_left": "torque that is left [-]",
    "feed_kept": "part of the feed kept [-]",
    "clearance_mm": "clearance [mm]",
    "wrist": "distance from the wrist singularity [-]",
    "shoulder": "distance from the shoulder singularity [-]",
    "elbow": "distance from the elbow singularity [-]",
}
"""of margins, for a reader"""
# squares of the map are this wide [mm]
_SQUARE = 100.0


def map_figure(found: Placement, up: int) -> Figure:
    """The area, square by square the best over what is not shown.

    Args:
        found: with every place that was looked at.
        up: axis of the base that the figure's upright axis shows: 1 from above, 2 from the side.
    """
    shown = [0, up]
    places = np.array([1e3 * at.middle for at, _ in found.seen])[:, shown]
    worth = np.array([outlook.worth for _, outlook in found.seen])
    squares, number = np.unique(np.rint(places / _SQUARE).astype(int), axis=0, return_inverse=True)
    best = np.full(len(squares), -np.inf)
    np.maximum.at(best, number.ravel(), worth)
    x, y = _SQUARE * squares.T
    refused = best < 0
    # the foot of the arm is drawn too
    wide, tall = (np.ptp(np.append(places, 0.0)) + 2 * _SQUARE for places in (x, y))
    height = float(np.clip(1.0 + 4.8 * tall / wide, 2.2, 6.0))
    figure = Figure(figsize=(4.6, height), layout="constrained")
    axes = figure.subplots()
    axes.grid(lw=0.6)
    axes.scatter(x[refused], y[refused], s=9, color="0.5", marker="x", label="cannot be done")
    can = axes.scatter(
        x[~refused], y[~refused], c=best[~refused], s=34, marker="s", vmin=0, vmax=1,
        cmap="viridis",
    )  # fmt: skip
    label = "worst margin, as a part of what is comfortable"
    figure.colorbar(can, ax=axes, label=label, location="bottom", aspect=40)
    axes.plot(0, 0, "^", color="black", label="foot of the arm")
    for name, outlook, mark in (("start", found.start, "o"), ("found", found.found, "*")):
        at = _middle(found, outlook)[shown]
        axes.plot(*at, mark, color="tab:red", ms=11, label=name)
    axes.set_aspect("equal")
    axes.margins(0.06)
    axes.set_xlabel("x of the part's middle [mm]")
    axes.set_ylabel(f"{'xyz'[up]} [mm]")
    axes.legend(fontsize="small", frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0, 1))
    return figure


def _middle(found: Placement, outlook: Outlook) -> Array:
    X = outlook.X_BW
    return np.asarray(1e3 * (X[:3, :3] @ found.middle + X[:3, 3]))


def margin_figure(start: Outlook, found: Outlook) -> Figure:
    """Margins as parts of what is comfortable, at first and now."""
    names = [name for name in COMFORTABLE_MARGINS if name in found.margins]
    figure = Figure(figsize=(4.6, 3.2), layout="constrained")
    axes = figure.subplots()
    axes.grid(lw=0.6, axis="x")
    axes.set_axisbelow(True)
    rows = np.arange(len(names))
    for shift, label, outlook, colour in (
        (-0.2, "start", start, "0.55"),
        (0.2, "found", found, "tab:blue"),
    ):
        parts = [max(outlook.parts.get(name, 0.0), 0.0) for name in names]
        told = f"{label}: {outlook.refused}" if outlook.refused else label
        axes.barh(rows + shift, parts, height=0.38, color=colour, label=told)
    axes.set_yticks(rows, [NAMES[name].partition(" [")[0] for name in names])
    axes.set_xlim(0, 1.05)
    axes.set_xlabel("part of what is comfortable")
    axes.invert_yaxis()
    axes.legend(fontsize="small", frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0, 1))
    return figure


def at_points(margin: str, value: float | None) -> float | str:
    """A margin at points along the path for a table; the clearance is measured there up to the
    comfortable one only."""
    if value is None:
        return "-"
    most = margin == "clearance_mm" and value >= COMFORTABLE_MARGINS[margin]
    return f"{value:.3g} or more" if most else value


def rail_figure(found: RailPosition) -> Figure:
    """The worst margin over the place of the carriage."""
    figure, axes = small(legend=True)
    at = np.array([position for position, _ in found.seen])
    worth = np.array([outlook.worth for _, outlook in found.seen])
    possible = worth >= 0
    axes.plot(at[possible], worth[possible], ".-", label="worst margin")
    axes.plot(at[~possible], np.zeros((~possible).sum()), "x", color="0.5", label="cannot be done")
    axes.axvline(found.position_mm, color="tab:red", ls="--", lw=0.9, label="found")
    axes.set_xlabel("place on the rail [mm]")
    axes.set_ylabel("1 is comfortable")
    axes.set_ylim(-0.05, 1.05)
    axes.legend(fontsize="small", frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0, 1))
    return figure
