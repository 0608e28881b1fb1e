"""The report of an identification."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.identification import Identification, LogResult
from irb2400_ctrl.report.friction_figures import friction_figure, law_rows, run_figure
from irb2400_ctrl.report.page import Page

MODELS = {
    "before": "file as given",
    "plain": "plain least squares",
    "unseen": "identified, unseen",
    "fitted": "identified, all logs",
}
FEW = 4
"""logs that are drawn"""


def identification_page(result: Identification) -> Page:
    """The whole report."""
    page = Page(f"Identification of {result.given.name}")
    page.heading("What was found")
    for sentence in result.notes or ["The bodies of the file are this arm's."]:
        page.finding(sentence)
    page.text(
        "Speed and acceleration are taken from the "
        + ("recorded speed." if result.source == "speed" else "angles.")
    )
    page.heading("Error on each log")
    for log in result.logs:
        page.table(f"{log.name} ({log.role}): RMSE over mean torque [%]", *error_rows(log))
    page.heading("What moved")
    page.table("Bodies, and how far they went from the file", *moved_rows(result))
    page.heading("Drives")
    page.table("Friction, offset and rotor, with standard errors", *drive_rows(result))
    if result.friction:
        page.heading("Friction at constant speed (eqs. 70-74)")
        page.table("As Tab. 5, with 95 % intervals", *law_rows(result.friction))
        page.figure(friction_figure(result.friction), "Friction of eq. 73 and its law (Fig. 9).")
        for curve in result.friction:
            page.figure(run_figure(curve), f"Joint {curve.joint}, forth and back (Fig. 8).")
    for log in result.logs[-FEW:]:
        page.heading(log.name)
        page.figure(parity_figure(log), "Predicted over measured torque, samples that count.")
        page.figure(residual_figure(log), "What is left over time, joint by joint.")
    page.heading("What these motions tell of every number")
    page.table("Identifiability from these motions alone", *verdict_rows(result))
    return page


def lines(result: Identification) -> list[str]:
    """The same in a few lines for a terminal."""
    found = list(result.notes or ["the bodies of the file are this arm's"])
    for log in result.logs:
        found.append(f"RMSE over mean torque on {log.name} ({log.role}) [%]:")
        for which, name in MODELS.items():
            values = log.error(which).rmse_over_mean_percent
            found.append(f"  {name:<21}" + " ".join(f"{v:7.1f}" for v in values))
    grades = [verdict.grade for verdict in result.verdicts]
    told = ", ".join(f"{grades.count(grade)} {grade}" for grade in dict.fromkeys(grades))
    return [*found, f"numbers that these motions show: {told}"]


def error_rows(log: LogResult) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a model a row, a joint a column."""
    head = ["model", *(f"joint {j + 1}" for j in range(log.measured.shape[1]))]
    rows: list[list[object]] = [
        [name, *(float(v) for v in log.error(which).rmse_over_mean_percent)]
        for which, name in MODELS.items()
    ]
    return head, rows


def moved_rows(result: Identification) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a link a row."""
    head = ["link", "mass before [kg]", "mass after [kg]", "furthest", "standard deviations"]
    rows: list[list[object]] = []
    for moved in result.moved:
        name, sigmas = moved.most
        masses = (float(moved.before[0]), float(moved.after[0]))
        rows.append([str(moved.link), *masses, name, f"{sigmas:+.1f}"])
    return head, rows


def drive_rows(result: Identification) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a number of a drive a row."""
    names = result.layout.names()
    first = result.layout.inertial
    rows: list[list[object]] = [
        [names[k], float(result.theta[k]), float(result.standard_errors[k])]
        for k in range(first, result.layout.count)
    ]
    return ["number", "value [SI]", "standard error"], rows


def verdict_rows(result: Identification) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a number a row."""
    rows: list[list[object]] = [
        [v.name, v.grade, v.stands_for, v.reason, v.motion] for v in result.verdicts
    ]
    return ["number", "verdict", "stands for", "why", "motion that would help"], rows


def parity_figure(log: LogResult) -> Figure:
    """Predicted over measured torque, a joint a panel."""
    n = log.measured.shape[1]
    figure = Figure(figsize=(9.0, 2.8 * ((n + 2) // 3)), layout="constrained")
    for j in range(n):
        axis = figure.add_subplot((n + 2) // 3, 3, j + 1)
        known = log.known[:, j]
        ends = [float(log.measured[:, j].min()), float(log.measured[:, j].max())]
        axis.plot(ends, ends, color="0.6", lw=0.8)
        axis.plot(log.measured[known, j], log.unseen[known, j], ".", ms=1.5, color="tab:blue")
        axis.set(xlabel=f"measured torque {j + 1} [Nm]", ylabel="predicted [Nm]")
        axis.grid(alpha=0.3)
    return figure


def residual_figure(log: LogResult) -> Figure:
    """Measured less predicted torque over time, a joint a panel."""
    n = log.measured.shape[1]
    figure = Figure(figsize=(9.0, 1.6 * n), layout="constrained")
    for j in range(n):
        axis = figure.add_subplot(n, 1, j + 1)
        left = np.where(log.known[:, j], log.measured[:, j] - log.unseen[:, j], np.nan)
        axis.plot(log.time - log.time[0], left, color="tab:blue", lw=0.6)
        axis.set(ylabel=f"{j + 1} [Nm]")
        axis.grid(alpha=0.3)
    axis.set(xlabel="time [s]")
    return figure
