"""The report of a validation: Tab. 6 and figures 10 to 12 of the paper."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.metrics import Errors
from irb2400_ctrl.identification import LogComparison, Validation
from irb2400_ctrl.identification.few_samples import few_samples
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.report.elements.page import Page, sentence, show
from irb2400_ctrl.report.elements.plots import Line, joint_plots
from irb2400_ctrl.report.figures.residual_figures import left_of
from irb2400_ctrl.report.figures.residual_view import residual_view
from irb2400_ctrl.report.pages.residual_section import add_parity, add_residual
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

NOTHING_MEASURED = 1e6
"""[%] of the mean torque, from which there is none"""


@typed
def validation_page(result: Validation, robot: Robot | None = None, log: Log | None = None) -> Page:
    """The whole report; with the robot and the first log its motion is replayed too.

    Args:
        result: the comparison; robot, log: whose motion is shown.
    """
    several = len(result.logs) > 1
    page = Page(f"{result.robot} against {', '.join(Path(seen.log).name for seen in result.logs)}")
    share = _share(result.error)
    least, most = (np.nan_to_num(share, nan=other) for other in (np.inf, 0.0))
    worst = int(np.argmax(most))
    page.answer(
        f"The model is off by {least.min():.1f} to {most.max():.1f} % of the mean torque, "
        f"most on joint {worst + 1}.",
        "note",
        [(f"joint {j + 1}, RMSE/AVG", f"{value:.1f} %") for j, value in enumerate(share)],
    )
    for seen in result.logs:
        if seen.problem:
            page.finding(f"{Path(seen.log).name} {seen.problem}.")
        for told in () if seen.problem else seen.changed:
            page.finding(f"{Path(seen.log).name}, {told}.")
    page.heading("Error (eqs. 75-77)")
    page.table(
        "Errors of the torque, as the paper's Tab. 6" + ", all logs" * several, *rows(result.error)
    )
    for seen in result.logs:
        if several:
            page.heading(Path(seen.log).name)
            page.table(f"Errors of the torque on {Path(seen.log).name}", *rows(seen.error))
        for remark in (*seen.remarks, *few_samples(seen)):
            page.text(sentence(remark))
        _add_log(page, seen)
    if robot is not None and log is not None:
        first = result.logs[0]
        left = left_of(first)[:, worst]
        page.heading("The recorded motion")
        view = residual_view(robot, log, first.time, {"by the model": left}, worst + 1)
        page.arm(view, f"The recorded motion, coloured by what is left on joint {worst + 1}.")
    return page


def _add_log(page: Page, seen: LogComparison) -> None:
    """Figures 10 to 12, what is left, its spectrum and what it goes with."""
    time = seen.time - seen.time[0]
    page.heading("Modelled and measured torque")
    lines = [
        Line(seen.measured, "0.55", "measured", 1.4),
        Line(np.where(seen.known, seen.modelled, np.nan), "tab:blue", "modelled", 0.8),
    ]
    drawn = joint_plots(time, lines, "torque {joint} [Nm]")
    page.figures(drawn, "Torque over time, as the paper's figure 12.", zoomable=True)
    left = left_of(seen)
    drawn = joint_plots(time, [Line(left, width=0.7)], "residual {joint} [Nm]")
    page.figures(drawn, "What the model leaves of it (the residual).", zoomable=True)
    drawn = joint_plots(time, [Line(np.degrees(seen.q))], "angle {joint} [deg]")
    page.figures(drawn, "Angles, as the paper's figure 10.", zoomable=True)
    drawn = joint_plots(time, [Line(np.degrees(seen.qd))], "speed {joint} [deg/s]")
    page.figures(drawn, "Speeds, as the paper's figure 11.", zoomable=True)
    page.heading("Parity, spectrum, correlation")
    add_parity(page, seen)
    add_residual(page, seen, [("left", left, "tab:blue")])


def rows(error: Errors) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a joint a row, the columns of Tab. 6."""
    head = ["joint", "MAE [Nm]", "RMSE [Nm]", "AVG [Nm]", "RMSE/AVG [%]"]
    share = _share(error)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.nan_to_num(100.0 * error.rmse / share)
    values = zip(error.mae, error.rmse, mean, share, strict=True)
    return head, [[str(j + 1), *(float(v) for v in row)] for j, row in enumerate(values)]


def _share(error: Errors) -> Array:
    """RMSE over the mean torque [%], (n,); none of a channel of zeros."""
    share = error.rmse_over_mean_percent
    return np.where(share < NOTHING_MEASURED, share, np.nan)


def lines(result: Validation) -> list[str]:
    """Tab. 6 for a terminal, of each log and of all."""
    found: list[str] = []
    tables = [(Path(log.log).name, log.error) for log in result.logs]
    if len(tables) > 1:
        tables.append(("all logs", result.error))
    for name, error in tables:
        if len(tables) > 1:
            found.append(name)
        found.append("joint  MAE [Nm]  RMSE [Nm]  AVG [Nm]  RMSE/AVG [%]")
        for joint, mae, rmse, mean, share in rows(error)[1]:
            told = [show(value) for value in (mae, rmse, mean, share)]
            found.append(f"{joint:>5}{told[0]:>10}{told[1]:>11}{told[2]:>10}{told[3]:>14}")
    for log in result.logs:
        said = [*log.notes, *few_samples(log)]
        found += [f"note: {Path(log.log).name}: {remark}" for remark in said]
    return found
