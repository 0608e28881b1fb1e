"""The report and the table of the main job."""

from __future__ import annotations

from typing import Any

from irb2400_ctrl.report.closed_loop_section import add_closed_loop, closed_loop_lines
from irb2400_ctrl.report.diagnosis_report import add_diagnosis, finding_title
from irb2400_ctrl.report.main_job import TORQUE_SHARE, MainJob
from irb2400_ctrl.report.page import Page
from irb2400_ctrl.report.plan_figures import plan_figures
from irb2400_ctrl.report.simulation_figures import torque_figure, tracking_figure

STEPS = (
    "One symbolic model of the arm does everything on this page: it times a CAM toolpath under "
    "torque limits, becomes "
    "controllers in C, is simulated in closed loop, and is compared with a measured log to find "
    "what it lacks."
)


def main_page(job: MainJob) -> Page:
    """report.html of `irb2400 demo`."""
    page = Page(f"{job.robot.name}: from toolpath and log to a better controller")
    page.text(STEPS)
    _add_plan(page, job)
    _add_code(page, job)
    _add_tracking(page, job)
    page.heading("What does the model lack?")
    page.text(
        f"A recorded motion of one arm ({job.diagnosis.identification.known.shape[0]} samples) is "
        "compared with the "
        "model as given. The error after is reported on the other motion of the same arm."
    )
    add_diagnosis(page, job.diagnosis)
    add_closed_loop(page, job.diagnosis, job.closed_loop)
    return page


def _add_plan(page: Page, job: MainJob) -> None:
    s = job.plan.summary()
    page.heading("The toolpath")
    page.text(
        f"{s['points']} points of {s['path']}, {s['length_mm']:,.0f} mm, in {s['duration_s']:.2f} "
        "s. "
        f"Tool rotation: {s['tool_rotation']}. "
        + ("The torque bound holds at every instant by construction." if s["guaranteed"] else "")
    )
    margin = s["singularity_margin"]
    page.table(
        "The plan in numbers",
        ("quantity", "value"),
        [
            ["TCP deviation, at most [mm]", float(s["max_tcp_deviation_mm"])],
            ["tool axis deviation, at most [deg]", float(s["max_tool_axis_deviation_deg"])],
            ["margin to the wrist singularity, |sin q5|", float(margin["wrist"])],
            ["margin to the shoulder singularity [m]", float(margin["shoulder"])],
            ["margin to the elbow singularity [m]", float(margin["elbow"])],
            ["clearance, at least [mm]", s["clearance_mm"]["value"] or "not known"],
            [
                f"torque over {100 * TORQUE_SHARE:.0f} % of its limit, at most",
                float(s["max_torque_ratio"]),
            ],
            ["speed over limit, at most", float(s["max_velocity_ratio"])],
            *_feed_rows(s["feed"]),
        ],
    )
    for caption, figure in plan_figures(job.plan).items():
        page.figure(figure, caption)


def _feed_rows(feed: dict[str, Any] | None) -> list[list[object]]:
    """On how much of the path the programmed feed is held, and what limits most of the rest."""
    if feed is None:
        return []
    rows: list[list[object]] = [
        ["programmed feed held, share of its path", float(feed["share_at_feed"])]
    ]
    for limit, length in list(feed["below_by_limit_mm"].items())[:3]:
        rows.append([f"below the feed for the {limit} [mm]", float(length)])
    return rows


def _add_code(page: Page, job: MainJob) -> None:
    page.heading("Controllers in C")
    page.text(
        "Generated from the symbolic model, compiled here, and compared with it state by state."
    )
    rows: list[list[object]] = []
    for name, verification in job.packages.items():
        v = verification
        rows.append(
            [name, v.real, v.states, v.max_relative_difference, "passed" if v.passed else "failed"]
        )
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
    page.figure(
        tracking_figure(job.tracking),
        "Distance of the TCP from its reference, and the worst of each joint.",
    )
    best = "computed_torque"
    page.figure(torque_figure(job.tracking[best], best), "Torque of each joint against its limits.")


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


def table(job: MainJob) -> str:
    """At most 20 lines for the terminal."""
    s = job.plan.summary()
    margin = s["singularity_margin"]
    torque = 100 * TORQUE_SHARE * s["max_torque_ratio"]
    found = [
        f"plan      {s['points']} points in {s['duration_s']:.2f} s, torque at most {torque:.1f} % "
        "of its limit" + (", at every instant" if s["guaranteed"] else ""),
        f"          margins: wrist {margin['wrist']:.3f}, shoulder {margin['shoulder']:.3f} m, "
        f"elbow {margin['elbow']:.3f} m",
    ]
    for name, v in job.packages.items():
        verdict = "equal to the model" if v.passed else "DIFFERS from the model"
        found.append(
            f"C         {name}: {verdict} within {v.max_relative_difference:.0e} over {v.states} "
            "states"
        )
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
        ("noise floor", job.diagnosis.noise_floor),
    ):
        found.append(
            f"          RMSE {name:<12} "
            + " ".join(f"{v:6.2f}" for v in values)
            + "  Nm, other motion"
        )
    found += [f"close     {line}" for line in closed_loop_lines(job.closed_loop)]
    return "\n".join(found)
