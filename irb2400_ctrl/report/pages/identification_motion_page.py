"""The report of the motions to identify an arm by."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.excitation.excitation import with_way
from irb2400_ctrl.excitation.identification_motion import UNSEEN, IdentificationMotion
from irb2400_ctrl.model import Model
from irb2400_ctrl.report.elements.arm_view import ArmView
from irb2400_ctrl.report.elements.page import Page, of_limit
from irb2400_ctrl.report.elements.plots import legend_above, logarithmic, wide
from irb2400_ctrl.report.figures import plan_figures as draw
from irb2400_ctrl.report.figures.excited_joints import KEPT_RANGE, add_joints, joint_rows
from irb2400_ctrl.typed import typed

FEW = 10
"""numbers that are shown least, in an open table"""


@typed
def identification_motion_page(found: IdentificationMotion, robot: str = "irb2400") -> Page:
    """The whole report."""
    model = Model(found.robot)
    motion = with_way(model, found.course, found.tau)
    runs = with_way(model, found.runs.course, found.runs.tau)
    page = Page(f"Motions to identify {found.robot.name} by")
    before, after = found.condition
    page.answer(
        f"Logs of these motions show {len(found.numbers)} numbers of the arm: condition number "
        f"{after:.0f}, that of a standard motion of the same time is {before:.0f}.",
        "good" if after < before else "note",
        _facts(found),
    )
    page.heading("How to run it")
    _add_how(page, found, robot)
    page.heading("The motion")
    colours = draw.colourings(motion, found.robot, found.robot.tau_max)
    view = ArmView(found.robot, motion.time, motion.q, colours)
    page.arm(view, "Run it in a free cell: nothing around the arm is known here.")
    page.heading("What it identifies")
    page.figure(
        shown_figure(found),
        "What a change that matters (a twentieth of its joint's torque) stands out by, in every "
        "direction of the arm's numbers; the worst direction first.",
    )
    head, rows = number_rows(found)
    page.table("The numbers that are shown least, each with all others free", head, rows[:FEW])
    page.table("Every number", head, rows, folded=True)
    page.text(
        "These are the motion's alone: what the robot file says of the bodies, with its "
        "uncertainty, adds to it. Numbers that no motion tells from others are left out."
    )
    page.heading("Each joint")
    add_joints(page, found.robot, motion)
    page.heading("Slow runs")
    page.text(
        f"Each joint runs forth and back at {len(found.runs.speeds[0])} constant speeds from "
        f"{found.runs.speeds[0][0]:.3g} rad/s on, where gravity asks little of it: its friction."
    )
    page.table("Largest values over the rows of the file", *joint_rows(found.robot, runs))
    angles = draw.angle_figures(runs, found.robot)
    page.figures(angles, KEPT_RANGE, True)
    return page


def _facts(found: IdentificationMotion) -> list[tuple[str, str]]:
    both = (found.extent, found.runs.extent)
    return [
        ("duration", f"{found.course.duration:.1f} s"),
        ("slow runs", f"{found.runs.course.duration:.0f} s"),
        ("torque, at most", of_limit(max(extent.torque for extent in both))),
        ("speed, at most", of_limit(max(extent.speed for extent in both))),
        ("acceleration, at most", of_limit(max(extent.acceleration for extent in both))),
        (
            "from the ends of the range kept",
            f"{np.degrees(min(extent.box for extent in both)):.0f} deg",
        ),
        ("lowest height", f"{min(extent.height for extent in both):.2f} m"),
    ]


def _add_how(page: Page, found: IdentificationMotion, robot: str) -> None:
    """What to do with the files."""
    modules = "; excitation.mod and friction_runs.mod are the same in RAPID"
    page.text(
        "trajectory.csv is the motion, friction_runs.csv the slow runs, 250 rows a second, for a "
        f"controller that follows rows{modules if found.robot.n == 6 else ''}. The slow runs may "
        "be left out: then friction at low speed stays open."
    )
    page.text(
        "Run both with the tool that the robot file has, slowly first: obstacles "
        "are unknown, only the base plane and the foot are kept clear. Then record time, angles "
        "and torques (or motor currents) of all joints at full speed."
    )
    page.finding(f"Then: {found.next_command(robot)}")


def shown_figure(found: IdentificationMotion) -> Figure:
    """Every direction of the arm's numbers, worst first, on both motions."""
    figure, axis = wide(2.6)
    for distances, colour, label in zip(
        found.distances, ("tab:gray", "tab:blue"), ("standard motion", "this motion"), strict=True
    ):
        places = np.arange(1, len(distances) + 1)
        axis.plot(places, np.maximum(distances, 1e-6), ".-", color=colour, label=label, lw=1.0)
    logarithmic(axis, "y")
    axis.set(xlabel="direction", ylabel="stands out by [standard errors]")
    legend_above(axis)
    return figure


def number_rows(found: IdentificationMotion) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a number a row, the one that is shown least first."""
    before, after = found.alone
    head = ["number", "standard motion [standard errors]", "this motion [standard errors]"]
    shown = [[_said(d) for d in distances] for distances in (before, after)]
    return head, [[found.numbers[k], shown[0][k], shown[1][k]] for k in np.argsort(after)]


def _said(distance: float) -> object:
    return float(f"{distance:.2g}") if distance >= UNSEEN else "cannot be seen"
