"""The report of a diagnosis, for the engineer who has to do something about it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from irb2400_ctrl.diagnosis import Comparison, Diagnosis, Finding
from irb2400_ctrl.diagnosis.numbers import off_bodies
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.report.effect_words import excite_line
from irb2400_ctrl.report.elements.page import Grade, Page, capital, sentence, show
from irb2400_ctrl.report.figures.diagnosis_figures import (
    closer_figures,
    curve_figure,
    residual_figure,
    residuals,
    torque_figure,
)
from irb2400_ctrl.report.figures.residual_view import residual_view
from irb2400_ctrl.report.pages.diagnosis_tables import (
    error_table,
    floor_shown,
    log_rows,
    parameter_rows,
    recalibration_rows,
    worse_elsewhere,
    worse_here,
)
from irb2400_ctrl.report.pages.three_lists import (
    LISTS,
    body_lines,
    entry_rows,
    findings_of,
    list_lines,
    lists_of,
    number_lines,
    number_rows,
    numbers_of,
)
from irb2400_ctrl.report.pages.verdict import verdict_sentence
from irb2400_ctrl.typed import typed
from irb2400_ctrl.wording import up_to

GRADES: dict[str, Grade] = {
    "explained": "note",
    "nothing_missing": "good",
    "unexplained": "bad",
    "log_not_understood": "bad",
}


@typed
def diagnosis_page(
    diagnosis: Diagnosis, title: str, log: Log | None = None, robot: str = "irb2400"
) -> Page:
    """The whole report; with the log its motion is replayed too.

    Args:
        diagnosis: what was found; title: of the page; log: whose motion is shown.
        robot: as the command line names it, for the line to run next.
    """
    page = Page(title)
    grade: Grade = GRADES[diagnosis.verdict]
    page.answer(_answer(diagnosis), grade, facts(diagnosis))
    add_diagnosis(page, diagnosis, log, robot)
    return page


def _answer(diagnosis: Diagnosis) -> str:
    """The verdict and the names."""
    named = [
        f"{entry.kind} on {entry.where} ({entry.confidence} sure)"
        for which in LISTS
        for entry in findings_of(diagnosis, which)
    ]
    more = f" and {len(named) - 3} more" if len(named) > 3 else ""
    said = verdict_sentence(diagnosis)
    if not named:
        return said
    begun = f"{said.removesuffix('.')}: " if diagnosis.verdict == "explained" else f"{said} Found: "
    return f"{begun}{', '.join(named[:3])}{more}."


def facts(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """Rms error of each joint's torque before and after."""
    compared = diagnosis.validation or diagnosis.identification
    pairs = zip(compared.error_before.rmse, compared.error_after.rmse, strict=True)
    tried = diagnosis.log_problem is None
    return [
        (f"joint {j}, error [Nm]", f"{show(was)} → {show(now)}" if tried else show(was))
        for j, (was, now) in enumerate(pairs, start=1)
    ]


def add_diagnosis(
    page: Page, diagnosis: Diagnosis, log: Log | None = None, robot: str = "irb2400"
) -> None:
    """The three lists first, then errors, figures, and what to measure next.

    Args:
        page: that is written; diagnosis: what was found; log: whose motion is shown.
        robot: as of `diagnosis_page`.
    """
    for line in _why(diagnosis):
        page.finding(line)
    _add_lists(page, diagnosis)
    _add_remarks(page, diagnosis)
    page.heading("Error before and after")
    for comparison in (diagnosis.identification, diagnosis.validation):
        if comparison is not None:
            tried = diagnosis.log_problem is None
            page.table(_caption(comparison, diagnosis), *error_table(comparison, tried))
    if len(diagnosis.logs) > 1:
        page.table("RMSE of each log before and after [Nm]", *log_rows(diagnosis))
    _add_findings(page, diagnosis, robot)
    _add_joints(page, diagnosis, log)
    for which, (heading, _) in lists_of(diagnosis).items():
        numbers = numbers_of(diagnosis, which)
        if numbers:
            page.heading(f"{heading}: every number")
            page.table("Numbers of the model, SI", *number_rows(numbers))
    rows = recalibration_rows(diagnosis.recalibrated, diagnosis.given)
    if rows:
        page.heading("Recalibrated")
        page.text(
            "Terms the model already has, with the values this arm needs; those of the bodies "
            "stand in robot.toml."
        )
        page.table(
            "Old and new values",
            ("term", *(f"joint {j + 1}" for j in range(diagnosis.given.n))),
            rows,
        )


def _add_findings(page: Page, diagnosis: Diagnosis, robot: str) -> None:
    """What has no name, then each effect on its own in the order of the lists: its law on the log,
    its numbers, what it may be instead."""
    for rest in diagnosis.unexplained:
        page.heading(f"Joint {rest.joint}: unexplained")
        page.figure(
            curve_figure(rest.curve, "generic form"),
            "What is left, over the signal that orders it best.",
        )
    order = list(LISTS)
    other = None if robot == "irb2400" else robot
    for finding in sorted(diagnosis.findings, key=lambda one: order.index(one.list)):
        page.heading(finding_title(finding))
        page.figure(
            curve_figure(finding.curve, f"law of {finding.effect.kind}"),
            f"The effect's own torque on joint {finding.curve.joint}: the log with all else taken "
            "off, and the law.",
        )
        page.table("Parameters", ("parameter", "value", "standard error"), parameter_rows(finding))
        if finding.splits:
            page.text(
                f"This log cannot exclude {', '.join(finding.alternatives)}. Measure next: "
                f"{finding.splits}. "
                f"A motion for it: {excite_line(finding.effect.kind, other)}"
            )


def _add_joints(page: Page, diagnosis: Diagnosis, log: Log | None) -> None:
    """Torque, residual, parity and spectrum of the joints that matter; the motion replayed."""
    compared = diagnosis.validation or diagnosis.identification
    joints = _joints_to_show(diagnosis)
    for joint in joints:
        page.heading(f"Torque of joint {joint}")
        page.figure(
            torque_figure(compared, joint),
            f"Joint {joint} on {Path(compared.name).name}, in the seconds in which the model as "
            "given is furthest off. Where a joint stands or turns round, its dry friction is not "
            "known: the models have gaps there, and such samples do not count.",
        )
        page.figures(
            [residual_figure(compared, joint)],
            "What is left, over the whole record.",
            zoomable=True,
        )
        page.figures(
            closer_figures(compared, joint),
            "Predicted over measured torque (on the line they agree); of what is left the root of "
            "the power spectrum, and the autocorrelation with the 99 % band of white noise.",
        )
    # several logs are joined into one record, whose time is not that of the first
    if log is None or len(diagnosis.logs) > 1 or diagnosis.log_problem is not None:
        return
    seen = diagnosis.identification
    before, after = residuals(seen, joints[0])
    page.heading("The recorded motion")
    view = residual_view(
        diagnosis.robot, log, seen.time, {"before": before, "after": after}, joints[0]
    )
    page.arm(view, f"The recorded motion, coloured by what is left on joint {joints[0]}.")


def _add_remarks(page: Page, diagnosis: Diagnosis) -> None:
    """What is left, what cannot be said, and what was left out."""
    for rest in diagnosis.unexplained:
        page.finding(
            f"Joint {rest.joint}: {rest.rmse:.2f} Nm rms are unexplained; they depend on "
            f"{', '.join(rest.depends_on)} ({rest.description})."
        )
    for remark in diagnosis.weak:
        page.text(sentence(remark))
    for one in diagnosis.left_out:
        page.text(f"Left out: {Path(one.name).name}: {one.why}.")


def _add_lists(page: Page, diagnosis: Diagnosis) -> None:
    """What changed, what is special, what the file lacks; each with what to do about it."""
    for which, (heading, advice) in lists_of(diagnosis).items():
        entries = findings_of(diagnosis, which)
        numbers = numbers_of(diagnosis, which)
        if not entries and not numbers:
            continue
        page.heading(heading)
        page.text(advice)
        for entry in entries:
            page.finding(
                f"{capital(entry.where)}: {entry.sentence} {entry.share} of the torque, "
                f"{entry.confidence} sure."
            )
            for line in body_lines(entry):
                page.text(f"{capital(line)}.")
            if entry.lookalikes and entry.splits:
                page.text(f"It could also be {entry.could_be}. To tell them apart: {entry.splits}.")
        for line in number_lines(numbers):
            page.finding(sentence(line))
        if entries:
            page.table("Findings", *entry_rows(entries))


def _why(diagnosis: Diagnosis) -> list[str]:
    """What is wrong with the log, and what is left after all that was found."""
    problem = diagnosis.log_problem
    if problem is not None:
        return [sentence(f"{problem.says} ({problem.kind})")]
    noise = diagnosis.noise
    # what is said of a joint already is not said again
    told = diagnosis.left_over if diagnosis.findings else ()
    unexplained = [rest.joint for rest in diagnosis.unexplained]
    known = bool(unexplained) and not diagnosis.findings
    found = [
        f"Joint {j}: {noise.left[j - 1]:.2f} Nm rms are left where neighbouring samples disagree "
        f"by {noise.floor[j - 1]:.2f}: more than noise."
        for j in diagnosis.beyond_noise
        if noise is not None and j in noise.beyond and j not in (*told, *unexplained) and not known
    ]
    bodies = off_bodies(diagnosis.numbers)
    found += [bodies] if bodies else []
    found += [
        f"Joint {j}: {diagnosis.mostly_left[j - 1]:.2f} Nm rms are left, noise is "
        f"{diagnosis.least_floor[j - 1]:.2f}"
        for j in told
        if j in diagnosis.much_left
    ]
    return found + worse_here(diagnosis) + worse_elsewhere(diagnosis)


def finding_title(finding: Finding) -> str:
    """`gear_ripple on joint 4`."""
    return finding.effect.kind + (
        "" if finding.effect.joint is None else f" on joint {finding.effect.joint}"
    )


def lines(diagnosis: Diagnosis) -> list[str]:
    """The same in a few lines for a terminal."""
    found = [f"verdict: {diagnosis.verdict}. {verdict_sentence(diagnosis)}"]
    found += [f"  {line}" for line in _why(diagnosis)]
    found += list_lines(diagnosis)
    found += [f"unexplained: {rest.line}" for rest in diagnosis.unexplained]
    found += [f"note: {remark}" for remark in diagnosis.weak]
    if len(diagnosis.logs) > 1:
        used = sum(log.used for log in diagnosis.logs)
        found.append(f"{used} logs together; {len(diagnosis.logs) - used} only judged")
    compared = diagnosis.validation or diagnosis.identification
    joints = up_to("joint", diagnosis.given.n)
    found.append(f"RMSE on {Path(compared.name).name} [Nm], {joints}:")
    told = {
        "before": compared.error_before.rmse,
        "recalibrated": compared.error_recalibrated.rmse,
        "after": compared.error_after.rmse,
        "noise floor": floor_shown(compared),
    }
    if diagnosis.log_problem is not None:  # nothing was tried: there is no after
        told = {"as given": compared.error_before.rmse}
    for name, values in told.items():
        found.append(f"  {name:<13}" + " ".join(f"{show(v):>8}" for v in values))
    return found


def _caption(comparison: Comparison, diagnosis: Diagnosis) -> str:
    which = (
        "the log it was found on"
        if comparison is diagnosis.identification
        else "the other motion of the same arm"
    )
    return f"{Path(comparison.name).name}, {which}: errors of the torque (eqs. 75-77), in Nm or %"


def _joints_to_show(diagnosis: Diagnosis) -> list[int]:
    """Joints whose torque a finding or a rest concerns most, at most four."""
    joints = [f.curve.joint for f in diagnosis.findings] + [u.joint for u in diagnosis.unexplained]
    if not joints:
        compared = diagnosis.validation or diagnosis.identification
        share = compared.error_before.rmse_over_mean_percent.copy()
        share[[j - 1 for j in diagnosis.not_excited]] = -1.0  # a resting joint has nothing to draw
        joints = [int(np.argmax(share)) + 1]
    return list(dict.fromkeys(joints))[:4]
