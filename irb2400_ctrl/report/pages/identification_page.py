"""The report of an identification."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.base_prior import BODY
from irb2400_ctrl.identification import Identification, LogResult
from irb2400_ctrl.identification.few_samples import few_samples
from irb2400_ctrl.identification.fitting.columns import DRIVE_TERMS
from irb2400_ctrl.identification.fitting.told_extras import KINDS, said_of
from irb2400_ctrl.identification.gate import Grade as Told
from irb2400_ctrl.identification.moved import ALARM, Moved
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import UNEVEN
from irb2400_ctrl.report.elements.page import Grade, Page, sentence, with_error
from irb2400_ctrl.report.elements.plots import Line, joint_plots, small
from irb2400_ctrl.report.figures.friction_figures import friction_figure, law_rows, run_figure
from irb2400_ctrl.report.figures.residual_figures import left_of
from irb2400_ctrl.report.figures.residual_view import residual_view
from irb2400_ctrl.report.pages.diagnosis_tables import UNITS
from irb2400_ctrl.report.pages.residual_section import add_parity, add_residual
from irb2400_ctrl.typed import typed
from irb2400_ctrl.wording import up_to

MODELS = {
    "before": "file as given",
    "plain": "plain least squares",
    "unseen": "identified, unseen",
    "fitted": "identified, all logs",
}
MOST_TOLD = 999.0
"""[%] of the torque left above which no number is told"""
FEW = 4
"""logs that are drawn"""
SHOWN = "identifiable"
TWICE = 1.96
"""standard deviations of 95 %"""


@typed
def identification_page(result: Identification, logs: Sequence[Log] = ()) -> Page:
    """The whole report; with the logs the first of them is replayed."""
    page = Page(f"Identification of {result.given.name}")
    page.answer(_sentence(result), _grade(result), _facts(result))
    page.heading("What was found")
    for note in (*result.of_bodies, *result.notes):
        page.finding(sentence(note))
    by_speed = result.source == "speed" or UNEVEN in result.notes
    page.text(
        f"Speed and acceleration are taken from the {'recorded speed' if by_speed else 'angles'}."
    )
    page.heading("Error on each log")
    for log in result.logs:
        page.table(
            f"{Path(log.name).name} ({log.role}): RMSE over mean torque [%]", *error_rows(log)
        )
        for said in few_samples(log):
            page.text(f"Of {Path(log.name).name}, identified, unseen: {said}.")
    page.text(
        "What the identified arm leaves is noise, or something that these numbers cannot express: "
        "irb2400 diagnose LOG --robot robot.toml says which."
    )
    if result.moved:
        _moved(page, result)
    page.heading("Drives")
    page.table("Friction, offset and rotor, with standard errors", *drive_rows(result))
    if result.layout.extras:
        page.table("What only some arms have", *extra_rows(result))
    if result.friction:
        page.heading("Friction at constant speed (eqs. 70-74)")
        page.table("As Tab. 5, with 95 % intervals", *law_rows(result.friction))
        page.figure(friction_figure(result.friction), "Friction of eq. 73 and its law (Fig. 9).")
        for curve in result.friction:
            page.figure(run_figure(curve), f"Joint {curve.joint}, forth and back (Fig. 8).")
    for log in result.logs[-FEW:]:
        _add_log(page, log)
    if logs:
        _add_motion(page, result, logs[0])
    page.heading("What these motions tell of every number")
    head, rows = verdict_rows(result)
    open_ones = [row for row in rows if row[1] != SHOWN]
    if open_ones:
        page.table("What these motions alone do not tell, and what would", head, open_ones)
    page.text(f"Identifiable are {len(rows) - len(open_ones)} of {len(rows)} numbers.")
    page.table("Identifiability of every number", head, rows, folded=True)
    page.figure(correlation_figure(result), "Which numbers these motions tell only together.")
    return page


def _judges(result: Identification) -> list[LogResult]:
    """The logs that no fit has seen, where some were given; else all, on stretches held out."""
    held = [log for log in result.logs if log.role == "validation"]
    return held or list(result.logs)


def _worst(result: Identification) -> LogResult:
    """The log of which most is left that the fit had not seen."""
    return max(_judges(result), key=lambda log: float(np.median(_shares(log, "unseen"))))


def _medians(log: LogResult) -> tuple[float, float]:
    """What the file leaves of a log and what the arm does, unseen: medians of the joints [%]."""
    return float(np.median(_shares(log, "before"))), float(np.median(_shares(log, "unseen")))


def _sentence(result: Identification) -> str:
    """How much of the torque the file left, and what is left now, on what the fit had not seen."""
    log = _worst(result)
    before, after = _medians(log)
    worst = ", the worst of the logs" if len(_judges(result)) > 1 else ""
    where = f", on {Path(log.name).name}{worst}" if len(result.logs) > 1 else ""
    return (
        f"The identified arm predicts torque it has not seen to {after:.1f} % of its mean (median "
        f"of the joints{where}); the file as given to {before:.1f} %."
    )


def _grade(result: Identification) -> Grade:
    """Good where the identified arm predicts better than its file."""
    before, after = _medians(_worst(result))
    return "good" if after < before else "note"


def _shares(log: LogResult, which: str) -> Array:
    return np.asarray(log.error(which).rmse_over_mean_percent)


def _facts(result: Identification) -> list[tuple[str, str]]:
    worst = _worst(result)
    return [
        (f"joint {j + 1}, RMSE/AVG", f"{was:.1f} → {now:.1f} %")
        for j, (was, now) in enumerate(
            zip(_shares(worst, "before"), _shares(worst, "unseen"), strict=True)
        )
    ]


def _add_log(page: Page, log: LogResult) -> None:
    """Parity, residual and its spectrum, before and after."""
    page.heading(Path(log.name).name)
    add_parity(page, log)
    before = np.where(log.known, log.measured - log.before, np.nan)
    models = [("file as given", before, "tab:red"), ("identified", left_of(log), "tab:blue")]
    lines = [Line(left, colour, label, 0.7) for label, left, colour in models]
    drawn = joint_plots(log.time - log.time[0], lines, "residual {joint} [Nm]")
    page.figures(drawn, "What is left over time.", zoomable=True)
    add_residual(page, log, models)


def _add_motion(page: Page, result: Identification, log: Log) -> None:
    seen = result.logs[0]
    worst = int(np.argmax(_shares(seen, "before")))
    residuals = {
        name: np.where(seen.known, seen.measured - model, np.nan)[:, worst]
        for name, model in (("by the file", seen.before), ("by the identified arm", seen.unseen))
    }
    page.heading("The recorded motion")
    view = residual_view(result.robot, log, seen.time, residuals, worst + 1)
    page.arm(view, f"{Path(log.name).name}, coloured by what is left on joint {worst + 1}.")


def lines(result: Identification) -> list[str]:
    """The same in a few lines for a terminal."""
    found = [*result.of_bodies, *result.notes]
    joints = up_to("joint", result.given.n)
    for log in result.logs:
        found.append(f"RMSE over mean torque on {log.name} ({log.role}) [%], {joints}:")
        for which, name in MODELS.items():
            values = log.error(which).rmse_over_mean_percent
            found.append(f"  {name:<21}" + " ".join(_share(v) for v in values))
        found += [f"  unseen, {said}" for said in few_samples(log)]
    grades = [verdict.grade for verdict in result.verdicts]
    told = ", ".join(
        f"{grades.count(grade)} {grade}" for grade in get_args(Told) if grade in grades
    )
    return [*found, f"what these motions tell of {len(grades)} numbers: {told}"]


def _share(percent: float) -> str:
    """Of what joints that hardly move do not determine no digits are told."""
    return f"{percent:7.1f}" if percent < MOST_TOLD else f"   >{MOST_TOLD:.0f}"


def error_rows(log: LogResult) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a model a row, a joint a column."""
    head = ["model", *(f"joint {j + 1}" for j in range(log.measured.shape[1]))]
    rows: list[list[object]] = [
        [name, *(float(v) for v in log.error(which).rmse_over_mean_percent)]
        for which, name in MODELS.items()
    ]
    return head, rows


def _moved(page: Page, result: Identification) -> None:
    """How far the bodies went from those of the file."""
    page.heading("What moved")
    page.table("Bodies, and how far they went from the file", *moved_rows(result))
    page.figures(
        [moved_figure(moved) for moved in result.moved],
        "Every number of a body, in standard deviations of the file: grey what the file leaves "
        "open, the bars what is open now (both 95 %). A short bar beyond the dashed lines: the "
        "file is wrong there. A bar as long as the grey is high: these motions do not show it; a "
        "longer one belongs to a body that the fit let go further than the file allows.",
    )


def moved_rows(result: Identification) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a link a row."""
    head = ["link", "mass before [kg]", "mass after [kg]", "moved most"]
    head += ["by [the file's standard deviations]", "± (95 %)"]
    rows: list[list[object]] = []
    for moved in result.moved:
        name, sigmas = moved.most
        masses = (float(moved.before[0]), float(moved.after[0]))
        open_now = TWICE * moved.errors[BODY.index(name)]
        rows.append([str(moved.link), *masses, name, f"{sigmas:+.1f}", f"{open_now:.1f}"])
    return head, rows


def drive_rows(result: Identification) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a joint a row, a kind of number a column."""
    layout = result.layout
    found: dict[str, list[object]] = {}
    for term in DRIVE_TERMS:
        own = layout.drive(term)
        pairs = zip(result.theta[own], result.standard_errors[own], strict=True)
        found[term] = [with_error(float(v), float(e)) for v, e in pairs]
    for extra in layout.extras:
        if extra.kind == "reading":  # of the two the difference alone is known
            found["rotor"][extra.joint - 1] = "not told"
    head = [f"{term} [{UNITS[term]}]" for term in found]
    rows = [[str(j), *row] for j, row in enumerate(zip(*found.values(), strict=True), start=1)]
    return ["joint", *head], rows


def extra_rows(result: Identification) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a number a row of what only some arms have."""
    layout = result.layout
    rows: list[list[object]] = []
    for extra in layout.extras:
        values, errors = layout.told(extra, result.theta, result.covariance)
        numbers = KINDS[extra.kind].numbers
        says = [said_of(extra), *("" for _ in numbers[1:])]
        for said, number, value, error in zip(says, numbers, values, errors, strict=True):
            joint = str(extra.joint) if said else ""
            rows.append([joint, said, number, with_error(float(value), float(error))])
    return ["joint", "which", "number", "with standard error"], rows


def verdict_rows(result: Identification) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a number a row."""
    rows: list[list[object]] = [
        [v.name, v.grade, v.stands_for, v.reason, v.motion] for v in result.verdicts
    ]
    return ["number", "verdict", "stands for", "why", "motion that would help"], rows


def moved_figure(moved: Moved) -> Figure:
    """The ten numbers of one body before and after, with what is open on both sides."""
    figure, axis = small(legend=True)
    places = np.arange(len(moved.sigmas))
    axis.axhspan(-TWICE, TWICE, color="tab:gray", alpha=0.25, lw=0)
    for limit in (-ALARM, ALARM):
        axis.axhline(limit, color="tab:red", ls="--", lw=0.9)
    bars = TWICE * moved.errors
    axis.errorbar(places, moved.sigmas, bars, fmt="o", color="tab:blue", ms=3.5, lw=1.2, capsize=2)
    reach = 1.15 * max(ALARM + 0.5, float(np.abs(moved.sigmas).max()))
    axis.set(ylabel="change / file's std. dev.", ylim=(-reach, reach))
    axis.set_title(f"link {moved.link}", fontsize=9)
    axis.set_xticks(places, [name.removesuffix("_kg").removesuffix("_m") for name in BODY])
    axis.tick_params(axis="x", labelrotation=45, labelsize=7)
    return figure


def correlation_figure(result: Identification) -> Figure:
    """Correlation of all numbers, from their covariance, blue -1 to red +1."""
    spread = np.sqrt(np.maximum(np.diag(result.covariance), 1e-300))
    figure = Figure(figsize=(6.0, 5.4), layout="constrained")
    axis = figure.subplots()
    image = axis.imshow(
        result.covariance / np.outer(spread, spread), cmap="RdBu_r", vmin=-1.0, vmax=1.0
    )
    names = result.layout.names()
    step = max(1, len(names) // 24)
    axis.set_yticks(range(0, len(names), step), names[::step], fontsize=6)
    axis.set_xticks([])
    figure.colorbar(image, label="correlation [-]")
    return figure
