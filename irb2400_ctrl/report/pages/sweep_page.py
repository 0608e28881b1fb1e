"""The report of a study over many plants."""

from __future__ import annotations

from irb2400_ctrl.report.elements.arm_view import ArmView
from irb2400_ctrl.report.elements.page import Page
from irb2400_ctrl.report.figures.plan_figures import colourings
from irb2400_ctrl.report.figures.sweep_figures import motion_figure, share_figure
from irb2400_ctrl.sweep.cases import case_of, reference
from irb2400_ctrl.sweep.run import Sweep
from irb2400_ctrl.sweep.table import SummaryLine
from irb2400_ctrl.typed import typed

MOST_PROBLEMS = 50
"""cases with a problem that are listed"""


@typed
def sweep_page(found: Sweep) -> Page:
    """The whole report."""
    page = Page(f"Study {found.study.name}")
    failed = sum(line.failed for line in found.lines)
    page.answer(_sentence(found.lines), "bad" if failed else "good", _facts(found, failed))
    page.heading("How the error spreads")
    page.figure(share_figure(found.lines), "Share of all runs below an error, by controller.")
    page.figure(motion_figure(found.lines), "Median, and 5 to 95 % of the runs, by motion.")
    page.table("TCP error rms over the plants [mm]", *rows(found.lines))
    _add_arm(page, found)
    if found.problems:
        page.heading("Cases with a problem")
        head = ["case", "controller", "motion", "status", "message"]
        listed = [[str(row[key]) for key in head] for row in found.problems[:MOST_PROBLEMS]]
        page.table(f"{len(found.problems)} in all, the first of them", head, listed)
    return page


def _add_arm(page: Page, found: Sweep) -> None:
    """The motion on which the error was largest, as it was asked for."""
    good = [row for row in found.rows if row["status"] == "ok"]
    if not good:
        return
    worst = max(good, key=lambda row: float(row["tcp_error_rms_mm"]))
    case = case_of(found.study, int(worst["case"]))
    motion = reference(found.study, case)
    robot = found.study.robot
    page.heading("The motion")
    page.arm(
        ArmView(robot, motion.time, motion.q, colourings(motion, robot, robot.tau_bound)),
        f"{case.motion.name} at speed {case.speed:g} as in case {case.index}, where the error is "
        "largest.",
    )


def rows(lines: list[SummaryLine]) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a controller on a motion a row."""
    head = ["motion", "speed", "controller", "median", "95 %", "worst"]
    head += ["runs at a torque limit", "at an end stop", "with refused samples", "failed"]
    return head, [
        [
            line.motion,
            f"{line.speed:g}",
            line.controller,
            *(f"{line.quantile(share):.3f}" for share in (0.5, 0.95, 1.0)),
            str(line.saturated),
            str(line.stopped),
            str(line.refused),
            str(line.failed),
        ]
        for line in lines
    ]


def _sentence(lines: list[SummaryLine]) -> str:
    """The controller with the smallest error that 95 % of its runs stay below."""
    known = [line for line in lines if line.errors_mm]
    if not known:
        return "No run of this study succeeded."
    worst = {
        name: max(line.quantile(0.95) for line in known if line.controller == name)
        for name in dict.fromkeys(line.controller for line in known)
    }
    best = min(worst, key=lambda name: worst[name])
    failed = sum(line.failed for line in lines)
    total = failed + sum(len(line.errors_mm) for line in lines)
    text = f"{failed} of {total} runs failed; of the others, 95" if failed else "95"
    text += f" % of the runs of {best} stay below {worst[best]:.3f} mm rms on every motion"
    others = len(worst) - 1
    if not others:
        return f"{text}."
    rest = f"none of the {others} other controllers is" if others > 1 else "the other one is not"
    return f"{text}; {rest} lower."


def _facts(found: Sweep, failed: int) -> list[tuple[str, str]]:
    return [
        ("cases", f"{found.study.cases}"),
        ("run now", f"{found.ran}"),
        ("failed", f"{failed}"),
        ("at a torque limit", f"{sum(line.saturated for line in found.lines)}"),
        ("at an end stop", f"{sum(line.stopped for line in found.lines)}"),
    ]
