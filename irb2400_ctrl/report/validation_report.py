"""The report of a validation: Tab. 6 and figures 10 to 12 of the paper."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irb2400_ctrl.identification import Validation
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.report.page import Page
from irb2400_ctrl.report.plots import Line, joint_plots, parity, spectrum
from irb2400_ctrl.report.residual_view import residual_view
from irb2400_ctrl.robot import Robot


def validation_page(result: Validation, robot: Robot | None = None, log: Log | None = None) -> Page:
    """The whole report; with robot and log the arm is replayed too."""
    names = ", ".join(Path(name).name for name in result.log.split(", "))
    page = Page(f"{result.robot} against {names}")
    share = result.error.rmse_over_mean_percent
    worst = int(np.argmax(share))
    page.answer(
        f"The model is off by {np.min(share):.0f} to {np.max(share):.0f} % of the mean torque, "
        f"most on joint {worst + 1}.",
        "note",
        [(f"joint {j + 1}, RMSE/AVG", f"{value:.1f} %") for j, value in enumerate(share)],
    )
    page.heading("Error (eqs. 75-77)")
    page.table("As Tab. 6", *rows(result))
    left = np.where(result.known, result.measured - result.modelled, np.nan)
    page.heading("Modelled and measured torque")
    modelled = np.where(result.known, result.modelled, np.nan)
    lines = [
        Line(result.measured, "0.55", "measured", 1.4),
        Line(modelled, "tab:blue", "modelled", 0.8),
    ]
    time = result.time - result.time[0]
    page.figures(
        joint_plots(time, lines, "torque {joint} [Nm]"), "As figures 10 to 12.", zoomable=True
    )
    drawn = joint_plots(time, [Line(left, width=0.7)], "residual {joint} [Nm]")
    page.figures(drawn, "What the model leaves.", zoomable=True)
    joints = range(result.measured.shape[1])
    known = [result.known[:, j] for j in joints]
    page.heading("Parity and spectrum")
    page.figures(
        [parity(result.measured[known[j], j], result.modelled[known[j], j], j + 1) for j in joints],
        "Parity: predicted over measured torque, samples that count.",
    )
    rate = 1.0 / float(np.median(np.diff(result.time)))
    page.figures(
        [spectrum([("left", left[:, j], "tab:blue")], rate, j + 1) for j in joints],
        "Root of the power spectrum of what is left.",
    )
    if robot is not None and log is not None:
        page.heading("The motion")
        view = residual_view(robot, log, result.time, {"by the model": left[:, worst]}, worst + 1)
        page.arm(view, f"The recorded motion, coloured by what is left on joint {worst + 1}.")
    return page


def rows(result: Validation) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a joint a row."""
    error = result.error
    head = ["joint", "MAE [Nm]", "RMSE [Nm]", "RMSE/AVG [%]"]
    values = zip(error.mae, error.rmse, error.rmse_over_mean_percent, strict=True)
    return head, [[str(j + 1), *(float(v) for v in row)] for j, row in enumerate(values)]


def lines(result: Validation) -> list[str]:
    """The table for a terminal."""
    found = ["joint  MAE [Nm]  RMSE [Nm]  RMSE/AVG [%]"]
    for joint, mae, rmse, share in rows(result)[1]:
        found.append(f"{joint:>5}{mae:10.3f}{rmse:11.3f}{share:14.2f}")
    return found
