"""The report of a validation: Tab. 6 and figures 10 to 12 of the paper."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.identification import Validation
from irb2400_ctrl.report.page import Page

A_FIGURE = 2
"""joints per figure, as in the paper"""


def validation_page(result: Validation) -> Page:
    """The whole report."""
    page = Page(f"{result.robot} against {result.log}")
    page.heading("Error (eqs. 75-77)")
    page.table("As Tab. 6", *rows(result))
    n = result.measured.shape[1]
    for first in range(0, n, A_FIGURE):
        joints = list(range(first, min(first + A_FIGURE, n)))
        names = " and ".join(str(j + 1) for j in joints)
        page.figure(torque_figure(result, joints), f"Modelled and measured torque, joints {names}.")
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


def torque_figure(result: Validation, joints: list[int]) -> Figure:
    """Torque over time, zero-based joints one below the other (figures 10-12)."""
    figure = Figure(figsize=(9.0, 2.8 * len(joints)), layout="constrained")
    for place, j in enumerate(joints):
        axis = figure.add_subplot(len(joints), 1, place + 1)
        time = result.time - result.time[0]
        modelled = np.where(result.known[:, j], result.modelled[:, j], np.nan)
        axis.plot(time, result.measured[:, j], color="0.55", lw=1.2, label="measured")
        axis.plot(time, modelled, color="tab:blue", lw=0.8, label="modelled")
        axis.set(ylabel=f"torque {j + 1} [Nm]")
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small", loc="upper right")
    axis.set(xlabel="time [s]")
    return figure
