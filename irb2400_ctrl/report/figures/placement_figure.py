"""Where a part may stand: the map of a search, and its margins before and after."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from irb2400_ctrl.planners.placement import Outlook, Placement, RailPosition
from irb2400_ctrl.planners.redundancy.comfort import COMFORTABLE_MARGINS

# squares of the map are this wide [mm]
_SQUARE = 100.0


def save_placement(found: Placement, out: Path) -> Path:
    """Write placement.png into a folder; returns its path."""
    path = out / "placement.png"
    placement_figure(found).savefig(path, dpi=120, metadata={"Software": None})
    return path


def placement_figure(found: Placement) -> Figure:
    """The area from above, in space, and the margins of the start and of what was found."""
    figure = Figure(figsize=(15.0, 5.2))
    figure.subplots_adjust(left=0.07, right=0.98, top=0.9, bottom=0.12, wspace=0.42)
    places = np.array([1e3 * at.middle for at, _ in found.seen])
    worth = np.array([outlook.worth for _, outlook in found.seen])
    _above(figure, figure.add_subplot(1, 3, 1), found, places, worth)
    _space(figure, found, places, worth)
    _bars(figure.add_subplot(1, 3, 3), found.start, found.found)
    return figure


def _middle(found: Placement, outlook: Outlook) -> np.ndarray:
    X = outlook.X_BW
    return np.asarray(1e3 * (X[:3, :3] @ found.middle + X[:3, 3]))


def _above(
    figure: Figure, axes: Axes, found: Placement, places: np.ndarray, worth: np.ndarray
) -> None:
    """Best over height and turn, square by square."""
    cell = np.rint(places[:, :2] / _SQUARE).astype(int)
    squares, number = np.unique(cell, axis=0, return_inverse=True)
    best = np.full(len(squares), -np.inf)
    np.maximum.at(best, number.ravel(), worth)
    x, y = _SQUARE * squares.T
    refused = best < 0
    axes.scatter(x[refused], y[refused], s=8, color="0.75", marker="x", label="cannot be done")
    shown = axes.scatter(
        x[~refused], y[~refused], c=best[~refused], s=40, marker="s", vmin=0, vmax=1,
        cmap="viridis",
    )  # fmt: skip
    figure.colorbar(shown, ax=axes, label="worst margin, 1 is comfortable")
    axes.plot(0, 0, "k^", label="foot of the arm")
    for name, outlook, mark in (("start", found.start, "o"), ("found", found.found, "*")):
        at = _middle(found, outlook)
        axes.plot(at[0], at[1], mark, color="tab:red", ms=11, mec="white", label=name)
    axes.set_aspect("equal")
    axes.set_xlabel("x of the part's middle [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_title("best over height and turn")
    axes.legend(fontsize=8, loc="upper left")


def _space(figure: Figure, found: Placement, places: np.ndarray, worth: np.ndarray) -> None:
    """All places that can be had, in space."""
    axes = figure.add_subplot(1, 3, 2, projection="3d")
    possible = worth >= 0
    axes.scatter(*places[possible].T, c=worth[possible], s=9, vmin=0, vmax=1, cmap="viridis")
    at = _middle(found, found.found)
    axes.plot(*at[:, None], "*", color="tab:red", ms=13)
    for name, value in zip("xyz", at, strict=True):
        getattr(axes, f"set_{name}label")(f"{name} [mm] ({value:.0f})")
    axes.set_title(f"{int(possible.sum())} of {len(worth)} places can be had")


def _bars(axes: Axes, start: Outlook, found: Outlook) -> None:
    """Margins as parts of what is comfortable."""
    names = list(COMFORTABLE_MARGINS)
    for k, (label, outlook, colour) in enumerate(
        (("start", start, "0.6"), ("found", found, "tab:blue"))
    ):
        parts = [max(outlook.parts.get(name, 0.0), 0.0) for name in names]
        rows = np.arange(len(names)) + 0.4 * k
        told = f"{label}: {outlook.refused}" if outlook.refused else label
        axes.barh(rows, parts, height=0.38, color=colour, label=told)
        for row, name in zip(rows, names, strict=True):
            if name in outlook.margins:
                axes.text(0.02, row, f"{outlook.margins[name]:.3g}", va="center", fontsize=8)
    given = [o.deflection for o in (start, found)]
    if None not in given:
        axes.set_title(f"gives way {1e3 * given[0]:.3f} mm at first, {1e3 * given[1]:.3f} mm now")  # type: ignore[operator]
    else:
        axes.set_title("margins at the stations")
    axes.set_yticks(np.arange(len(names)) + 0.2, [name.replace("_", " ") for name in names])
    axes.set_xlim(0, 1.05)
    axes.set_xlabel("part of what is comfortable")
    axes.invert_yaxis()
    axes.legend(fontsize=8, loc="lower right")


def rail_figure(found: RailPosition) -> Figure:
    """The worst margin over the place of the carriage."""
    figure = Figure(figsize=(9.0, 4.0))
    figure.subplots_adjust(left=0.09, right=0.98, top=0.92, bottom=0.14)
    axes = figure.subplots()
    at = np.array([position for position, _ in found.seen])
    worth = np.array([outlook.worth for _, outlook in found.seen])
    possible = worth >= 0
    axes.plot(at[possible], worth[possible], ".-", label="worst margin, 1 is comfortable")
    axes.plot(at[~possible], np.zeros((~possible).sum()), "x", color="0.6", label="cannot be done")
    axes.axvline(found.position_mm, color="tab:red", label=f"found: {found.position_mm:g} mm")
    axes.set_xlabel("place on the rail [mm]")
    axes.set_ylim(-0.05, 1.05)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8)
    return figure
