"""The report of a diagnosis, for the engineer who has to do something about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.diagnosis import Comparison, Diagnosis, Finding
from irb2400_ctrl.diagnosis.preparation.moved_numbers import sentence as moved_sentence
from irb2400_ctrl.effects.base import OPEN_END_S
from irb2400_ctrl.report.diagnosis_figures import curve_figure, torque_figure
from irb2400_ctrl.report.page import Page, show

VERDICTS = {
    "explained": "The log shows something the model lacks, and it has a name.",
    "nothing_missing": "Nothing is missing: what is left after recalibration is noise.",
    "unexplained": "Something is left that no effect of the library makes.",
    "log_not_understood": "The log is not what its columns say: no effect was tried.",
}


def diagnosis_page(diagnosis: Diagnosis, title: str) -> Page:
    """The whole report."""
    page = Page(title)
    add_diagnosis(page, diagnosis)
    return page


def add_diagnosis(page: Page, diagnosis: Diagnosis) -> None:
    """Verdict, findings with their figures, errors before and after, what is left and what to
    measure next."""
    page.heading("Verdict")
    page.text(VERDICTS[diagnosis.verdict])
    for line in _why(diagnosis):
        page.finding(line)
    for finding in diagnosis.findings:
        page.finding(finding_line(finding))
    for rest in diagnosis.unexplained:
        page.finding(
            f"Joint {rest.joint}: {rest.rmse:.2f} Nm rms are unexplained; they depend on "
            f"{', '.join(rest.depends_on)}. "
            f"{rest.description}"
        )
    for joint in diagnosis.not_excited:
        page.text(f"Joint {joint} hardly moves in this log: nothing can be said about it.")
    for sentence in diagnosis.weak:
        page.text(sentence)

    page.heading("Error before and after")
    for comparison in (diagnosis.identification, diagnosis.validation):
        if comparison is not None:
            page.table(
                _caption(comparison, diagnosis), *error_table(comparison, diagnosis.noise_floor)
            )

    compared = diagnosis.validation or diagnosis.identification
    for finding in diagnosis.findings:
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
                f"A motion for it: irb2400 excite --for {finding.effect.kind} --out next"
            )
    for rest in diagnosis.unexplained:
        page.heading(f"Joint {rest.joint}: unexplained")
        page.figure(
            curve_figure(rest.curve, "generic form"),
            "What is left, over the signal that orders it best.",
        )
    for joint in _joints_to_show(diagnosis):
        page.figure(
            torque_figure(compared, joint),
            f"Joint {joint} on {Path(compared.name).name}: measured torque, model, residual.",
        )
    rows = recalibration_rows(diagnosis.recalibrated)
    if rows:
        page.heading("Recalibrated")
        page.text("Terms the model already has, with the values this arm needs.")
        page.table(
            "New values", ("term", *(f"joint {j + 1}" for j in range(diagnosis.given.n))), rows
        )


def _why(diagnosis: Diagnosis) -> list[str]:
    """What is wrong with the log, and what is left after all that was found."""
    problem = diagnosis.log_problem
    if problem is not None:
        return [f"{problem.says[0].upper()}{problem.says[1:]} ({problem.kind})."]
    left = diagnosis.identification.error_after.rmse
    noise = diagnosis.noise
    found = [
        f"Joint {j}: {noise.left[j - 1]:.2f} Nm rms are left where neighbouring samples disagree "
        f"by {noise.floor[j - 1]:.2f}: more than noise."
        for j in diagnosis.beyond_noise
        if noise is not None and not diagnosis.findings and not diagnosis.unexplained
    ]
    moved = moved_sentence(diagnosis.moved, diagnosis.given.n)
    found += [moved] if moved else []
    return found + [
        f"Joint {j}: {left[j - 1]:.2f} Nm rms are left, noise is {diagnosis.noise_floor[j - 1]:.2f}"
        for j in diagnosis.left_over
        if diagnosis.findings
    ]


def finding_title(finding: Finding) -> str:
    """`gear_ripple on joint 4`."""
    return finding.effect.kind + (
        "" if finding.effect.joint is None else f" on joint {finding.effect.joint}"
    )


def finding_line(finding: Finding) -> str:
    """One sentence with the name, the size and how surely."""
    share = 100 * float(np.max(finding.share))
    text = f"{finding.sentence} ({finding_title(finding)}, {share:.1f} % of the joint's torque, "
    text += f"confidence {100 * finding.confidence:.0f} %, "
    text += f"{finding.validation_gain:.0f} % less error on unseen stretches"
    if finding.alternatives:
        text += f"; not excluded: {', '.join(finding.alternatives)}"
    return text + ")"


def lines(diagnosis: Diagnosis) -> list[str]:
    """The same in a few lines for a terminal."""
    found = [f"verdict: {diagnosis.verdict}. {VERDICTS[diagnosis.verdict]}"]
    found += [f"  {line}" for line in _why(diagnosis)]
    found += [f"  {finding_line(f)}" for f in diagnosis.findings]
    found += [
        f"  joint {u.joint}: {u.rmse:.2f} Nm rms unexplained, depends on {', '.join(u.depends_on)}"
        for u in diagnosis.unexplained
    ]
    compared = diagnosis.validation or diagnosis.identification
    found.append(f"RMSE on {Path(compared.name).name} [Nm], joints 1 to {diagnosis.given.n}:")
    for name, values in (
        ("before", compared.error_before.rmse),
        ("recalibrated", compared.error_recalibrated.rmse),
        ("after", compared.error_after.rmse),
        ("noise floor", diagnosis.noise_floor),
    ):
        found.append(f"  {name:<13}" + " ".join(f"{v:8.2f}" for v in values))
    return found


def error_table(
    comparison: Comparison, floor: np.ndarray
) -> tuple[Sequence[str], list[list[object]]]:
    """Head and rows of eqs. 75-77, one row per joint; RMSE also after recalibration alone, and the
    noise floor."""
    before = comparison.error_before
    recalibrated = comparison.error_recalibrated
    after = comparison.error_after
    columns = {
        "joint": [str(j + 1) for j in range(len(floor))],
        "MAE before": before.mae,
        "MAE after": after.mae,
        "RMSE before": before.rmse,
        "recali\xadbrated": recalibrated.rmse,
        "RMSE after": after.rmse,
        "noise floor": floor,
        "RMSE/AVG before %": before.rmse_over_mean_percent,
        "RMSE/AVG after %": after.rmse_over_mean_percent,
    }
    rows: list[list[object]] = [list(row) for row in zip(*columns.values(), strict=True)]
    return tuple(columns), rows


def parameter_rows(finding: Finding) -> list[list[object]]:
    """Name, value, standard error."""

    def text(value: Any) -> str:
        if not isinstance(value, list | tuple):
            return show(float(value))
        return ", ".join(
            window(*v) if isinstance(v, list | tuple) else show(float(v)) for v in value
        )

    def window(start: float, stop: float) -> str:
        return (
            f"{show(float(start))} to {show(float(stop))}"
            if stop < OPEN_END_S
            else f"{show(float(start))} on"
        )

    errors = finding.standard_errors
    return [
        [name, text(value), text(errors[name]) if name in errors else ""]
        for name, value in finding.effect.parameters().items()
    ]


def recalibration_rows(recalibrated: Mapping[str, Any]) -> list[list[object]]:
    """One row per term with a value for each joint (mass data of the links stand in robot.toml)."""
    rows: list[list[object]] = []
    for term, values in recalibrated.items():
        flat = (
            np.asarray(values, dtype=float)
            if isinstance(values, list | tuple | np.ndarray)
            else np.empty((0, 0))
        )
        if flat.ndim == 1 and flat.size:
            rows.append([term, *(float(v) for v in flat)])
    return rows


def _caption(comparison: Comparison, diagnosis: Diagnosis) -> str:
    which = (
        "the log it was found on"
        if comparison is diagnosis.identification
        else "the other motion of the same arm"
    )
    return f"{Path(comparison.name).name}, {which}: eqs. 75-77 in Nm and %"


def _joints_to_show(diagnosis: Diagnosis) -> list[int]:
    """Joints whose torque a finding or a rest concerns most, at most four."""
    joints = [f.curve.joint for f in diagnosis.findings] + [u.joint for u in diagnosis.unexplained]
    if not joints:
        compared = diagnosis.validation or diagnosis.identification
        joints = [int(np.argmax(compared.error_before.rmse_over_mean_percent)) + 1]
    return list(dict.fromkeys(joints))[:4]
