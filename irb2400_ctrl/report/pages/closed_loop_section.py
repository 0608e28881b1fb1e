"""The section that shows what a finding is worth to the controller."""

from __future__ import annotations

from irb2400_ctrl.diagnosis import Diagnosis
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.figures.simulation_figures import joint_figure, tracking_figure
from irb2400_ctrl.report.pages.diagnosis_page import finding_title
from irb2400_ctrl.simulation.close_the_loop import ClosedLoop


def add_closed_loop(page: Page, diagnosis: Diagnosis, loop: ClosedLoop) -> None:
    """Tracking of the recorded motion by the controllers of the robot as given, recalibrated and as
    diagnosed."""
    found = ", ".join(finding_title(f) for f in diagnosis.findings) or "recalibrated parameters"
    page.heading("The loop closed")
    page.text(
        f"The controller ({loop.controller}) is generated again from the robot with what was found "
        f"({found}). All "
        "controllers follow the commanded motion of the log. Gains follow the same rule."
    )
    page.text(
        "The arm is this library's own simulation: it has the effects exactly as found, and its "
        "masses, centres of "
        "mass, inertias and friction differ from what was found by what a log leaves open, a "
        "quarter of the data "
        "sheet's uncertainty. So this is what the finding is worth to the controller if it is "
        "right; whether it is "
        "right, the validation log says."
    )
    left_alone = [finding_title(f) for f in diagnosis.findings if f.effect.role == "measurement"]
    if left_alone:
        page.text(
            f"No controller makes up for {', '.join(left_alone)}: it is in the measuring chain, to "
            "be put right there."
        )
    in_part = [f for f in diagnosis.findings if f.effect.windows_s]
    known = {(e.kind, e.joint) for e in loop.after.robot.effects}
    for words, there in (
        ("began in the record and is taken as lasting", True),
        ("was an event and is left out", False),
    ):
        if names := [
            finding_title(f) for f in in_part if ((f.effect.kind, f.effect.joint) in known) is there
        ]:
            page.text(f"What acted only part of the time: {', '.join(names)} {words}.")
    runs = {f"robot as {name}": run for name, run in loop.runs.items()}
    rows: list[list[object]] = []
    for name, run in runs.items():
        s = run.summary()
        rows.append(
            [name, *s["tcp_error_mm"].values(), *(1e3 * v for v in s["joint_error_deg"]["rms"])]
        )
    joints = (f"axis {j + 1} rms [mdeg]" for j in range(loop.plant.n))
    page.table(
        "Tracking before and after",
        ("controller from", "TCP rms [mm]", "TCP max [mm]", *joints),
        rows,
    )
    ends = {name: run for name, run in runs.items() if run is not loop.recalibrated}
    page.figure(
        tracking_figure(ends),
        "The same motion and structure; only the description behind it differs.",
        zoomable=True,
    )
    page.figure(joint_figure(ends), "Largest error of each joint.")


def closed_loop_lines(loop: ClosedLoop) -> list[str]:
    """The same in a few lines for a terminal."""
    found = []
    for name, run in loop.runs.items():
        e = run.summary()["tcp_error_mm"]
        found.append(
            f"robot as {name:<13} TCP error {e['rms']:.3f} mm rms, {e['max']:.3f} mm at most"
        )
    return found
