"""Whether what a model leaves is noise: its autocorrelation, and what of the motion it goes
with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification import LogComparison, LogResult
from irb2400_ctrl.identification.residual_tests import (
    Dependence,
    autocorrelation,
    dependences,
    fit_percent,
    white_band,
)
from irb2400_ctrl.report.elements.plots import legend_above, small

LAG_S = 0.4
"""shown of an autocorrelation [s]"""
LASTING_S = 0.05
"""after which noise has forgotten itself [s]"""
LONG = 0.2
"""autocorrelation that is left then, above which there is a cause"""
AUTOCORRELATION = (
    "The autocorrelation of what is left, with the 99 % band of white noise: what stays outside "
    "for long is slower than noise, and may have a cause."
)
TESTED = (
    "What is left goes with what of its joint: correlation, in brackets what chance stays below in "
    "19 of 20 cases; ! is more, and more than 0.1"
)
SIGNALS = ("angle", "speed", "direction", "acceleration", "modelled torque")
Judged = LogResult | LogComparison


def autocorrelation_figure(
    lines: Sequence[tuple[str, Array, str]], rate: float, joint: int
) -> Figure:
    """Of one joint, a line a model.

    Args:
        lines: label, residual [Nm] shape (m,) with gaps as NaN, colour.
        rate: samples per second [1/s].
        joint: for the label.
    """
    figure, axis = small(len(lines) > 1)
    some = [line for line in lines if np.isfinite(line[1]).any()]
    if some:
        band = white_band(some[0][1])
        axis.axhspan(-band, band, color="tab:gray", alpha=0.25, lw=0)
    for name, left, colour in some:
        lags = max(1, min(round(LAG_S * rate), len(left) // 4))
        values = autocorrelation(left, lags)
        axis.plot(np.arange(lags + 1) / rate, values, color=colour, lw=1.0, label=name)
    axis.set(xlabel="lag [s]", ylabel=f"autocorrelation {joint} [-]", ylim=(-1.05, 1.05))
    axis.set_xlim(0.0, LAG_S)
    if len(some) > 1:
        legend_above(axis)
    return figure


def left_of(log: Judged) -> Array:
    """What the model leaves, NaN where a sample does not count, (m, n) [Nm]."""
    return np.where(log.known, log.measured - log.modelled, np.nan)


def residual_tests(log: Judged) -> list[list[Dependence]]:
    """How much of each joint's residual goes with what of its own motion."""
    rate = 1.0 / float(np.median(np.diff(log.time)))
    signals = (log.q, log.qd, np.sign(log.qd), np.gradient(log.qd, log.time, axis=0), log.modelled)
    found = []
    for j, left in enumerate(left_of(log).T):
        if not np.isfinite(left).any():
            found.append([Dependence(name, 0.0, 1.0) for name in SIGNALS])
            continue
        values = (signal[:, j] for signal in signals)
        found.append(dependences(left, dict(zip(SIGNALS, values, strict=True)), rate))
    return found


def tested_rows(
    tests: Sequence[Sequence[Dependence]], log: Judged
) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a joint a row, its fit and its correlations."""
    head = ["joint", "fit [%]", *SIGNALS]
    fits = fit_percent(log.measured, log.modelled, log.known)
    rows: list[list[object]] = [
        [
            str(j + 1),
            f"{fit:.2f}",
            *(f"{d.correlation:+.2f} ({d.chance:.2f}){' !' * d.notable}" for d in joint),
        ]
        for j, (fit, joint) in enumerate(zip(fits, tests, strict=True))
    ]
    return head, rows


def lasting(log: Judged) -> Array:
    """Autocorrelation of each joint's residual after `LASTING_S`, (n,); 0 where there is none."""
    lag = max(1, round(LASTING_S / float(np.median(np.diff(log.time)))))
    left = left_of(log)
    found = np.zeros(left.shape[1])
    for j, of_joint in enumerate(left.T):
        if np.isfinite(of_joint).any():
            found[j] = np.nan_to_num(autocorrelation(of_joint, lag)[-1])
    return found


def told_of_tests(tests: Sequence[Sequence[Dependence]], lasts: Array) -> str:
    """The same in a sentence: per joint what it goes with most, or that it lasts."""
    found = []
    for j, joint in enumerate(tests, start=1):
        notable = [d for d in joint if d.notable]
        if notable:
            most = max(notable, key=lambda d: abs(d.correlation))
            found.append(f"on joint {j} it goes with the {most.signal} ({most.correlation:+.2f})")
        elif lasts[j - 1] > LONG:
            found.append(
                f"on joint {j} it lasts (autocorrelation {lasts[j - 1]:.2f} after "
                f"{1e3 * LASTING_S:.0f} ms)"
            )
    if not found:
        return "What is left goes with none of these more than by chance, and does not last."
    return (
        f"What is left is more than noise: {', '.join(found)}. Direction points to dry friction, "
        "speed to viscous friction, acceleration to inertia, angle to weight or a spring, modelled "
        "torque to its scale; what lasts and goes with none of them may be a ripple or a swing. "
        "irb2400 diagnose LOG names the cause."
    )
