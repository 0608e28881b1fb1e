"""Plots that all reports share: one small figure a joint, side by side on a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, ScalarFormatter

from irb2400_ctrl.arrays import Array

_MOST_DOTS = 500
_MOST_ROWS = 1500
"""of a line: more than a page is wide, so that a zoom shows more than the whole"""


@dataclass(frozen=True)
class Line:
    """One curve over time.

    Args:
        values: shape (m,); NaN leaves a gap.
        colour: as Matplotlib's.
        label: for the legend; empty for none.
        width: [pt].
    """

    values: Array
    colour: str = "tab:blue"
    label: str = ""
    width: float = 1.0


class _Thousands(ScalarFormatter):
    """`250k` from 100000 on: the margin of a small plot holds no more."""

    def set_locs(self, locs: list[float]) -> None:
        """Ticks of the axis."""
        super().set_locs(locs)
        self._large = bool(np.abs(locs).max(initial=0.0) >= 1e5)

    def __call__(self, x: float, pos: int | None = None) -> str:
        """The label of a tick."""
        if self._large and x:
            return f"{x / 1e3:g}k".replace("-", "\N{MINUS SIGN}")
        return str(super().__call__(x, pos))


def small(legend: bool = False) -> tuple[Figure, Axes]:
    """One plot that is read on a phone too. Margins stated: working them out from the labels takes
    longer than drawing."""
    figure = Figure(figsize=(4.6, 2.5 if legend else 2.2))
    figure.subplots_adjust(left=0.19, right=0.96, top=0.86 if legend else 0.95, bottom=0.2)
    axis = figure.subplots()
    _behind(axis)
    axis.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    axis.yaxis.set_major_formatter(_Thousands())
    return figure, axis


def wide(height: float) -> tuple[Figure, Axes]:
    """A plot as wide as the page."""
    figure = Figure(figsize=(7.0, height), layout="constrained")
    axis = figure.subplots()
    _behind(axis)
    return figure, axis


def _behind(axis: Axes) -> None:
    """A grid that crosses neither bars nor curves."""
    axis.grid(lw=0.6)
    axis.set_axisbelow(True)


def over_time(
    time: Array,
    lines: Sequence[Line],
    label: str,
    limits: Sequence[float] = (),
    floor: float | None = None,
) -> Figure:
    """A small plot of curves over time [s].

    Args:
        time: shape (m,).
        lines: the first below the others.
        label: of the upright axis, with its unit.
        limits: dashed.
        floor: lowest value of the axis.
    """
    named = any(line.label for line in lines)
    figure, axis = small(named)
    for line in lines:
        x, y = _alone_too(*thin(time, line.values))
        axis.plot(x, y, color=line.colour, lw=line.width, label=line.label or None)
    for limit in limits:
        if np.isfinite(limit):
            axis.axhline(limit, color="tab:red", ls="--", lw=0.9)
    if floor is not None:
        top = axis.get_ylim()[1]
        axis.set_ylim(floor, top + 0.05 * (top - floor))
    axis.set(xlabel="time [s]", ylabel=label, xlim=(time[0], time[-1]))
    if named:
        legend_above(axis)
    return figure


def joint_plots(
    time: Array,
    lines: Sequence[Line],
    label: str,
    limits: Sequence[Array] = (),
    floor: float | None = None,
) -> list[Figure]:
    """One small plot a joint.

    Args:
        time: shape (m,).
        lines: their values are (m, n).
        label: with `{joint}` in it, such as "torque {joint} [Nm]".
        limits: each (n,), dashed.
        floor: lowest value of the axis.
    """
    return [
        over_time(
            time,
            [Line(line.values[:, j], line.colour, line.label, line.width) for line in lines],
            label.format(joint=j + 1),
            [float(limit[j]) for limit in limits],
            floor,
        )
        for j in range(lines[0].values.shape[1])
    ]


def thin(time: Array, values: Array) -> tuple[Array, Array]:
    """Smallest and largest of groups of samples, where there are more than a figure shows; gaps
    stay."""
    group = 2 * len(time) // _MOST_ROWS
    if group < 3:
        return time, values
    count = len(time) // group * group
    parts = values[:count].reshape(-1, group)
    known = np.isfinite(parts)
    low = np.where(known, parts, np.inf).min(axis=1)
    high = np.where(known, parts, -np.inf).max(axis=1)
    some = np.isfinite(low)
    both = np.stack([np.where(some, low, np.nan), np.where(some, high, np.nan)], axis=1)
    times = np.repeat(time[:count:group], 2)
    return np.append(times, time[-1]), np.append(both.ravel(), values[-1])


def _alone_too(time: Array, values: Array) -> tuple[Array, Array]:
    """With a short stroke for each sample between two gaps, of which no line leads to another."""
    known = np.isfinite(values)
    beside = np.convolve(known, [1, 0, 1], "same") > 0
    alone = np.flatnonzero(known & ~beside)
    if not len(alone):
        return time, values
    half = 0.5 * float(np.ptp(time)) / max(len(time) - 1, 1)
    drawn = time.copy()
    drawn[alone] -= half
    ends = time[alone] + half
    return np.insert(drawn, alone + 1, ends), np.insert(values, alone + 1, values[alone])


def parity(
    measured: Array, predicted: Array, joint: int, model: str = "", colour: str = "tab:blue"
) -> Figure:
    """Predicted over measured torque of one joint; the name of the model above, if there are
    several.

    Args:
        measured: torque [Nm], shape (m,).
        predicted: torque [Nm], shape (m,).
        joint: counted from 1.
        model: its name; empty for none.
        colour: of the dots, as Matplotlib's.
    """
    figure, axis = small(bool(model))
    some = np.linspace(0, len(measured) - 1, min(len(measured), _MOST_DOTS)).round().astype(int)
    if len(measured):  # a joint that stands has no sample that counts
        ends = [float(np.min(measured)), float(np.max(measured))]
        axis.plot(ends, ends, color="0.6", lw=0.9)
    axis.plot(measured[some], predicted[some], ".", ms=2, color=colour, alpha=0.6, label=model)
    axis.set(xlabel=f"measured torque {joint} [Nm]", ylabel="predicted [Nm]")
    if model:
        legend_above(axis)
    return figure


def spectrum(lines: Sequence[tuple[str, Array, str]], rate: float, joint: int) -> Figure:
    """Power of what is left over the frequency (Welch), one line a model.

    Args:
        lines: label, residual [Nm] shape (m,) with gaps as NaN, colour.
        rate: samples per second [1/s].
        joint: for the label.
    """
    from scipy.signal import welch

    named = len(lines) > 1
    figure, axis = small(named)
    some = [line for line in lines if np.nan_to_num(line[1]).any()]
    for name, residual, colour in some:
        known = np.nan_to_num(residual)
        frequency, power = welch(known, fs=rate, nperseg=min(512, len(known)))
        axis.plot(frequency[1:], np.sqrt(power[1:]), color=colour, lw=1.0, label=name)
    axis.set(
        xlabel="frequency [Hz]",
        ylabel=f"residual {joint} [Nm/√Hz]",
        xlim=(0.0, rate / 2),
    )
    if some:  # a joint that stands leaves nothing that counts
        logarithmic(axis, "y")
    if named and some:
        legend_above(axis)
    return figure


def logarithmic(axis: Axes, which: Literal["x", "y"]) -> None:
    """Over a decade or two, 1-2-5 reads better than powers of ten; with more there would be no
    room."""
    least = axis.dataLim.minposx if which == "x" else axis.dataLim.minposy
    if not np.isfinite(least):  # nothing above zero
        return
    (axis.set_xscale if which == "x" else axis.set_yscale)("log")
    scale = axis.xaxis if which == "x" else axis.yaxis
    low, high = axis.get_xlim() if which == "x" else axis.get_ylim()
    steps = (1.0, 2.0, 5.0) if high / low < 100 else (1.0,)
    scale.set_major_locator(LogLocator(subs=steps))
    scale.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    scale.set_minor_formatter(NullFormatter())


def legend_above(axis: Axes) -> None:
    """Above the plot, in one row."""
    axis.legend(
        fontsize="small",
        frameon=False,
        ncols=3,
        loc="lower left",
        bbox_to_anchor=(0.0, 0.99),
        borderaxespad=0.1,
        handlelength=1.2,
        columnspacing=1.0,
    )
