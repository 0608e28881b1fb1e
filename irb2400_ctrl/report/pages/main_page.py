"""The report and the table of the main job."""

from __future__ import annotations

from typing import Any

import numpy as np

from irb2400_ctrl.codegen.verification import Verification
from irb2400_ctrl.report.elements.page import Page, of_limit
from irb2400_ctrl.report.figures.simulation_figures import (
    joint_figure,
    torque_figures,
    tracking_figure,
)
from irb2400_ctrl.report.main_job import MainJob
from irb2400_ctrl.report.pages.closed_loop_section import add_closed_loop, closed_loop_lines
from irb2400_ctrl.report.pages.diagnosis_page import add_diagnosis, finding_title
from irb2400_ctrl.report.pages.plan_page import add_plan
from irb2400_ctrl.report.pages.plan_page import sentence as plan_sentence
from irb2400_ctrl.report.pages.simulation_page import arm_view
from irb2400_ctrl.report.pages.verdict import verdict_sentence

STEPS = (
    "One symbolic model of the arm does everything on this page: it times a CAM toolpath under "
    "torque limits, becomes "
    "controllers in C, is simulated in closed loop, and is compared with a measured log to find "
    "what it lacks."
)


def main_page(job: MainJob) -> Page:
    """report.html of `irb2400 demo`: what was found and what it is worth, then step by step."""
    page = Page(f"{job.robot.name}: from toolpath and log to a better controller")
    page.answer(_sentence(job), "good", _facts(job))
    page.text(STEPS)
    page.heading("The toolpath")
    page.text(plan_sentence(job.plan.summary()))
    add_plan(page, job.plan)
    _add_code(page, job)
    _add_tracking(page, job)
    page.heading("What does the model lack?")
    page.text(
        f"A recorded motion of one arm ({job.diagnosis.identification.known.shape[0]} samples) is "
        "compared with the "
        "model as given. The error after is reported on the other motion of the same arm."
    )
    page.finding(verdict_sentence(job.diagnosis))
    add_diagnosis(page, job.diagnosis, job.log)
    add_closed_loop(page, job.diagnosis, job.closed_loop)
    return page


def _sentence(job: MainJob) -> str:
    """What the log showed, and what it is worth."""
    found = ", ".join(finding_title(finding) for finding in job.diagnosis.findings)
    runs = {name: run.summary()["tcp_error_mm"] for name, run in job.closed_loop.runs.items()}
    before = runs["given"]["rms"]
    after = runs["diagnosed"]["rms"]
    lacked = f"The log shows what the model lacked: {found}" if found else "The model lacks nothing"
    return f"{lacked}. The controller made again tracks to {after:.3f} mm rms, before {before:.3f}."


def _facts(job: MainJob) -> list[tuple[str, str]]:
    plan = job.plan.summary()
    compared = job.diagnosis.validation or job.diagnosis.identification
    joint = int(np.argmax(compared.error_before.rmse / compared.error_after.rmse))
    was = compared.error_before.rmse[joint]
    now = compared.error_after.rmse[joint]
    equal = sum(v.passed for v in job.packages.values())
    return [
        (f"joint {joint + 1}, RMSE", f"{was:.2f} → {now:.2f} Nm"),
        ("its noise floor", f"{compared.noise_floor[joint]:.2f} Nm"),
        ("toolpath", f"{plan['duration_s']:.1f} s"),
        ("torque, at most", of_limit(plan["max_torque_ratio"])),
        ("C packages equal to the model", f"{equal} of {len(job.packages)}"),
    ]


def _add_code(page: Page, job: MainJob) -> None:
    page.heading("Controllers in C")
    page.text(
        "Generated from the symbolic model, compiled here, and compared with it state by state."
    )
    rows: list[list[object]] = []
    for name, v in job.packages.items():
        verdict = "passed" if v.passed else "failed" if v.checked else "not checked"
        rows.append([name, v.real, v.states, v.max_relative_difference, verdict])
    page.table(
        "Packages", ("controller", "type", "states", "largest relative difference", "verdict"), rows
    )


def _add_tracking(page: Page, job: MainJob) -> None:
    page.heading("Closed loop on an arm that differs from the model")
    page.text(
        "1 kHz control in generated C, quantised encoders, saturated torques; masses, centres of "
        "mass, inertias and "
        "friction of the plant differ from the model by what a data sheet leaves open."
    )
    rows = []
    for name, run in job.tracking.items():
        s = run.summary()
        errors = (*s["tcp_error_mm"].values(), *s["contour_error_mm"].values())
        rows.append([name, *(float(v) for v in errors)])
    head = ("controller", "TCP rms [mm]", "TCP max [mm]", "contour rms [mm]", "contour max [mm]")
    page.table("Tracking of the toolpath", head, rows)
    page.figure(tracking_figure(job.tracking), "Distance of the TCP from its reference.", True)
    page.figure(joint_figure(job.tracking), "Largest error of each joint.")
    best = job.tracking["computed_torque"]
    page.arm(arm_view(best), "The arm under computed_torque.")
    page.figures(
        torque_figures(best), "Torque under computed_torque; limits are dashed.", zoomable=True
    )


def summary(job: MainJob) -> dict[str, Any]:
    """What every step of the main job says of itself, under JSON names."""
    return {
        "plan": job.plan.summary(),
        "codegen": {
            name: {"passed": v.passed, "max_relative_difference": v.max_relative_difference}
            for name, v in job.packages.items()
        },
        "simulate": {name: run.summary() for name, run in job.tracking.items()},
        "diagnose": job.diagnosis.to_json(),
        "closed_loop": job.closed_loop.summary(),
    }


def _compared(v: Verification) -> str:
    """What is known of a package; without a C compiler nothing is."""
    if not v.checked:
        return "written, not checked: " + "; ".join(one.split(" (")[0] for one in v.missing)
    verdict = "equal to the model" if v.passed else "DIFFERS from the model"
    return f"{verdict} within {v.max_relative_difference:.0e} over {v.states} states"


def table(job: MainJob) -> str:
    """At most 20 lines for the terminal."""
    s = job.plan.summary()
    margin = s["singularity_margin"]
    torque = 100 * s["max_torque_ratio"]
    found = [
        f"plan      {s['points']} points in {s['duration_s']:.2f} s, torque at most {torque:.1f} % "
        "of its limit" + (", at every instant" if s["guaranteed"] else ""),
        f"          singularity margins: wrist {margin['wrist']:.3f}, "
        f"shoulder {margin['shoulder']:.3f} m, elbow {margin['elbow']:.3f} m",
    ]
    for name, v in job.packages.items():
        found.append(f"C         {name}: {_compared(v)}")
    for name, run in job.tracking.items():
        e = run.summary()["tcp_error_mm"]
        found.append(
            f"track     {name:<16} TCP error {e['rms']:.3f} mm rms, {e['max']:.3f} mm at most"
        )
    found.append(f"diagnose  verdict: {job.diagnosis.verdict}")
    for finding in job.diagnosis.findings:
        found.append(
            f"          {finding_title(finding)}, confidence {100 * finding.confidence:.0f} %"
        )
    compared = job.diagnosis.validation or job.diagnosis.identification
    for name, values in (
        ("before", compared.error_before.rmse),
        ("after", compared.error_after.rmse),
        ("noise floor", compared.noise_floor),
    ):
        found.append(
            f"          RMSE {name:<12} "
            + " ".join(f"{v:6.2f}" for v in values)
            + "  Nm, other motion"
        )
    found += [f"close     {line}" for line in closed_loop_lines(job.closed_loop)]
    return "\n".join(found)
