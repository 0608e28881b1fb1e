"""The section that shows what a finding is worth to the controller."""

from __future__ import annotations

from irb2400_ctrl.diagnosis import Diagnosis
from irb2400_ctrl.report.diagnosis_report import finding_title
from irb2400_ctrl.report.page import Page
from irb2400_ctrl.report.simulation_figures import tracking_figure
from irb2400_ctrl.simulation.close_loop import ClosedLoop


def add_closed_loop(page: Page, diagnosis: Diagnosis, loop: ClosedLoop) -> None:
    """Tracking of the recorded motion by the controller of the robot as given and as diagnosed."""
    names = ", ".join(finding_title(f) for f in diagnosis.findings) or "recalibrated parameters"
    page.heading("The loop closed")
    page.text(
        f"The controller ({loop.controller}) is generated again from the robot with what was found ({names}). Both "
        "controllers follow the commanded motion of the log on a simulated arm that has what was found and whose other "
        "parameters differ from both descriptions. Gains follow the same rule."
    )
    runs = {"robot as given": loop.before, "robot as diagnosed": loop.after}
    rows: list[list[object]] = []
    for name, run in runs.items():
        s = run.summary()
        rows.append([name, *s["tcp_error_mm"].values(), *(1e3 * v for v in s["joint_error_deg"]["rms"])])
    joints = (f"axis {j + 1} rms [mdeg]" for j in range(loop.plant.n))
    page.table("Tracking before and after", ("controller from", "TCP rms [mm]", "TCP max [mm]", *joints), rows)
    page.figure(tracking_figure(runs), "The same motion and structure; only the description behind it differs.")


def closed_loop_lines(loop: ClosedLoop) -> list[str]:
    """The same in two lines for a terminal."""
    found = []
    for name, run in (("given", loop.before), ("diagnosed", loop.after)):
        e = run.summary()["tcp_error_mm"]
        found.append(f"robot as {name:<10} TCP error {e['rms']:.3f} mm rms, {e['max']:.3f} mm at most")
    return found
