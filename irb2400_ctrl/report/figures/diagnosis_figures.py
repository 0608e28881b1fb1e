"""Figures of a diagnosis."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import Comparison, Curve
from irb2400_ctrl.report.elements.plots import Line, over_time, parity, spectrum, wide
from irb2400_ctrl.report.figures.residual_figures import autocorrelation_figure

GAP = 3.5
"""times the usual step from one bin to the next, over which no line is drawn"""
_SECONDS = 10.0
"""shown of a torque"""

AXIS_NAMES = {
    "q": "angle",
    "qd": "speed",
    "qdd": "acceleration",
    "load": "load torque",
    "time": "time",
}


def torque_figure(comparison: Comparison, joint: int) -> Figure:
    """Measured torque of one joint against the model before and after, over the
    seconds in which the model before was furthest off.

    Args:
        comparison: before and after, on one log.
        joint: counted from 1.
    """
    j = joint - 1
    time = comparison.time - comparison.time[0]
    known = comparison.known[:, j]
    before, _ = residuals(comparison, joint)
    start = _worst_start(time, np.nan_to_num(before))
    shown = (time >= start) & (time <= start + _SECONDS)
    figure, axis = wide(3.4)
    axis.plot(time[shown], comparison.measured[shown, j], color="0.55", lw=2.0, label="measured")
    # at standstill dry friction is undetermined and the model's sign of speed only follows the
    # noise
    for model, color, name in (
        (comparison.before, "tab:red", "model as given"),
        (comparison.after, "tab:blue", "model with what was found"),
    ):
        values = np.where(known, model[:, j], np.nan)[shown]
        axis.plot(time[shown], values, color=color, lw=0.9, label=name)
    axis.set(xlabel="time [s]", ylabel=f"torque {joint} [Nm]", xlim=(start, time[shown][-1]))
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False, ncols=3)
    return figure


def residuals(comparison: Comparison, joint: int) -> tuple[Array, Array]:
    """What the model leaves of one joint's torque before and after [Nm], gaps as NaN."""
    j = joint - 1
    known = comparison.known[:, j]
    measured = comparison.measured[:, j]
    before = np.where(known, measured - comparison.before[:, j], np.nan)
    after = np.where(known, measured - comparison.after[:, j], np.nan)
    return before, after


def residual_figure(comparison: Comparison, joint: int) -> Figure:
    """What is left over the whole record, before and after."""
    before, after = residuals(comparison, joint)
    lines = [
        Line(before, "tab:red", "as given", 0.6),
        Line(after, "tab:blue", "with what was found", 0.6),
    ]
    time = comparison.time - comparison.time[0]
    return over_time(time, lines, f"residual {joint} [Nm]")


def closer_figures(comparison: Comparison, joint: int) -> list[Figure]:
    """Parity before and after, spectrum and autocorrelation of what is left."""
    j = joint - 1
    known = comparison.known[:, j]
    before, after = residuals(comparison, joint)
    rate = 1.0 / float(np.median(np.diff(comparison.time)))
    measured = comparison.measured[known, j]
    left = [("as given", before, "tab:red"), ("with what was found", after, "tab:blue")]
    return [
        parity(measured, comparison.before[known, j], joint, "as given", "tab:red"),
        parity(measured, comparison.after[known, j], joint, "with what was found"),
        spectrum(left, rate, joint),
        autocorrelation_figure(left, rate, joint),
    ]


def curve_figure(curve: Curve, law: str) -> Figure:
    """An effect's own torque: what the log shows once all else is taken off, with its band, and the
    law."""
    figure, axis = wide(3.6)
    x, low, high, line = _with_gaps(curve.x, curve.x, curve.low, curve.high, curve.law)
    axis.fill_between(x, low, high, color="0.8", label="log, 95 % band")
    axis.plot(curve.x, curve.measured, "o", ms=3, color="0.35", label="log, mean of the bin")
    if np.isfinite(curve.law).all() and np.any(curve.law):
        axis.plot(x, line, color="tab:blue", lw=1.5, label=law)
    direction = ", against the motion" if curve.turned else ""
    axis.set(
        xlabel=f"{_signal_name(curve.signal)} [{curve.unit}]",
        ylabel=f"torque {curve.joint} of the effect{direction} [Nm]",
    )
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False, ncols=3)
    return figure


def _with_gaps(x: Array, *values: Array) -> list[Array]:
    """Values over rising x with a NaN where nothing was recorded between two of them."""
    step = np.diff(x)
    usual = float(np.median(step)) if len(step) else 0.0
    behind = np.flatnonzero(step > GAP * usual) + 1
    return [np.insert(each.astype(float), behind, np.nan) for each in values]


def _signal_name(signal: str) -> str:
    """`q4` -> angle 4, `load` -> load torque."""
    stem = signal.rstrip("0123456789")
    digits = signal[len(signal.rstrip("0123456789")) :]
    return f"{AXIS_NAMES.get(stem, stem)} {digits}".rstrip()


def _worst_start(time: np.ndarray, residual: np.ndarray) -> float:
    """Start of the window that holds the most residual energy."""
    if time[-1] <= _SECONDS:
        return 0.0
    energy = np.concatenate([[0.0], np.cumsum(residual**2)])
    count = int(np.searchsorted(time, _SECONDS))
    window = energy[count:] - energy[:-count]
    return float(time[int(np.argmax(window[: len(time) - count + 1]))])
