"""The report of a validation: Tab. 6 and figures 10 to 12 of the paper."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.diagnosis.preparation.metrics import Errors
from irb2400_ctrl.identification import LogComparison, Validation
from irb2400_ctrl.report.page import Page

A_FIGURE = 3
"""joints per figure, as in the paper"""


def validation_page(result: Validation) -> Page:
    """The whole report."""
    page = Page(f"{result.robot} against {', '.join(log.log for log in result.logs)}")
    page.heading("Error (eqs. 75-77)")
    page.table("As Tab. 6" + (", all logs" if len(result.logs) > 1 else ""), *rows(result.error))
    for log in result.logs:
        page.heading(log.log)
        if len(result.logs) > 1:
            page.table(f"As Tab. 6, {log.log}", *rows(log.error))
        n = log.measured.shape[1]
        for first in range(0, n, A_FIGURE):
            joints = list(range(first, min(first + A_FIGURE, n)))
            names = f"joints {joints[0] + 1}-{joints[-1] + 1}"
            page.figure(motion_figure(log, joints), f"Angles and speeds, {names} (Figs. 10, 11).")
            page.figure(torque_figure(log, joints), f"Modelled and measured, {names} (Fig. 12).")
    return page


def rows(error: Errors) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a joint a row, the columns of Tab. 6."""
    head = ["joint", "MAE [Nm]", "RMSE [Nm]", "AVG [Nm]", "RMSE/AVG [%]"]
    share = error.rmse_over_mean_percent
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = 100.0 * error.rmse / share
    values = zip(error.mae, error.rmse, mean, share, strict=True)
    return head, [[str(j + 1), *(float(v) for v in row)] for j, row in enumerate(values)]


def lines(result: Validation) -> list[str]:
    """Tab. 6 for a terminal, of each log and of all."""
    found: list[str] = []
    tables = [(log.log, log.error) for log in result.logs]
    if len(tables) > 1:
        tables.append(("all logs", result.error))
    for name, error in tables:
        found.append(f"{name}: joint  MAE [Nm]  RMSE [Nm]  AVG [Nm]  RMSE/AVG [%]")
        for joint, mae, rmse, mean, share in rows(error)[1]:
            label = f"{joint:>{len(name) + 7}}"
            found.append(f"{label}{mae:10.3f}{rmse:11.3f}{mean:10.3f}{share:14.2f}")
    return found


def motion_figure(log: LogComparison, joints: list[int]) -> Figure:
    """Angles and speeds over time, the input of the model (figures 10, 11)."""
    figure = Figure(figsize=(9.0, 4.5), layout="constrained")
    for place, (signal, name) in enumerate(((log.q, "angle [deg]"), (log.qd, "speed [deg/s]"))):
        axis = figure.add_subplot(2, 1, place + 1)
        for j in joints:
            axis.plot(log.time - log.time[0], np.degrees(signal[:, j]), lw=0.8, label=f"{j + 1}")
        axis.set(ylabel=name)
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small", loc="upper right")
    axis.set(xlabel="time [s]")
    return figure


def torque_figure(log: LogComparison, joints: list[int]) -> Figure:
    """Torque over time, zero-based joints one below the other (figure 12)."""
    figure = Figure(figsize=(9.0, 2.3 * len(joints)), layout="constrained")
    for place, j in enumerate(joints):
        axis = figure.add_subplot(len(joints), 1, place + 1)
        time = log.time - log.time[0]
        modelled = np.where(log.known[:, j], log.modelled[:, j], np.nan)
        axis.plot(time, log.measured[:, j], color="0.55", lw=1.2, label="measured")
        axis.plot(time, modelled, color="tab:blue", lw=0.8, label="modelled")
        axis.set(ylabel=f"torque {j + 1} [Nm]")
        axis.grid(alpha=0.3)
        axis.legend(fontsize="small", loc="upper right")
    axis.set(xlabel="time [s]")
    return figure
