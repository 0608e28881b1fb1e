"""Figures of a diagnosis."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.diagnosis import Comparison, Curve

AXIS_NAMES = {
    "q": "angle",
    "qd": "speed",
    "qdd": "acceleration",
    "load": "load torque",
    "time": "time",
}


def torque_figure(comparison: Comparison, joint: int, seconds: float = 10.0) -> Figure:
    """Measured torque of one joint against the model before and after, and what is left over the
    whole record.

    The upper plot shows the stretch of `seconds` in which the model before was furthest off.
    """
    j = joint - 1
    time = comparison.time - comparison.time[0]
    known = comparison.known[:, j]
    before = np.where(known, comparison.measured[:, j] - comparison.before[:, j], np.nan)
    after = np.where(known, comparison.measured[:, j] - comparison.after[:, j], np.nan)
    start = _worst_start(time, np.nan_to_num(before), seconds)
    shown = (time >= start) & (time <= start + seconds)

    figure = Figure(figsize=(9.0, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1)
    upper.plot(time[shown], comparison.measured[shown, j], color="0.55", lw=2.0, label="measured")
    # at standstill dry friction is undetermined and the model's sign of speed only follows the
    # noise
    for model, color, name in (
        (comparison.before, "tab:red", "model as given"),
        (comparison.after, "tab:blue", "model with what was found"),
    ):
        upper.plot(
            time[shown],
            np.where(known, model[:, j], np.nan)[shown],
            color=color,
            lw=0.9,
            label=name,
        )
    upper.set(xlabel="time [s]", ylabel=f"torque {joint} [Nm]")
    upper.legend(loc="best", fontsize="small")
    lower.plot(time, before, color="tab:red", lw=0.6, label="left by the model as given")
    lower.plot(time, after, color="tab:blue", lw=0.6, label="left with what was found")
    lower.set(xlabel="time [s]", ylabel=f"residual {joint} [Nm]")
    lower.legend(loc="upper right", fontsize="small")
    for axis in (upper, lower):
        axis.grid(alpha=0.3)
    return figure


def curve_figure(curve: Curve, law: str) -> Figure:
    """An effect's own torque: what the log shows once all else is taken off, with its band, and the
    law."""
    figure = Figure(figsize=(7.0, 3.8), layout="constrained")
    axis = figure.subplots()
    axis.fill_between(curve.x, curve.low, curve.high, color="0.8", label="log, 95 % band")
    axis.plot(curve.x, curve.measured, "o", ms=3, color="0.35", label="log, mean of the bin")
    if np.isfinite(curve.law).all() and np.any(curve.law):
        axis.plot(curve.x, curve.law, color="tab:blue", lw=1.5, label=law)
    direction = ", against the motion" if curve.turned else ""
    axis.set(
        xlabel=f"{_signal_name(curve.signal)} [{curve.unit}]",
        ylabel=f"torque {curve.joint} of the effect{direction} [Nm]",
    )
    axis.grid(alpha=0.3)
    axis.legend(fontsize="small")
    return figure


def _signal_name(signal: str) -> str:
    """`q4` -> angle 4, `load` -> load torque."""
    stem = signal.rstrip("0123456789")
    digits = signal[len(signal.rstrip("0123456789")) :]
    return f"{AXIS_NAMES.get(stem, stem)} {digits}".rstrip()


def _worst_start(time: np.ndarray, residual: np.ndarray, seconds: float) -> float:
    """Start of the window that holds the most residual energy."""
    if time[-1] <= seconds:
        return 0.0
    energy = np.concatenate([[0.0], np.cumsum(residual**2)])
    count = int(np.searchsorted(time, seconds))
    window = energy[count:] - energy[:-count]
    return float(time[int(np.argmax(window[: len(time) - count + 1]))])
