"""The report of a motion that tells effects apart."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.excitation.excitation import Excitation
from irb2400_ctrl.excitation.pair_separability import CLEAR
from irb2400_ctrl.report.elements.arm_view import ArmView
from irb2400_ctrl.report.elements.page import Page, of_limit
from irb2400_ctrl.report.elements.plots import logarithmic, wide
from irb2400_ctrl.report.figures import plan_figures as draw
from irb2400_ctrl.report.figures.excited_joints import add_joints
from irb2400_ctrl.typed import typed

MOST = 24
"""pairs that are drawn; the least separated ones"""


@typed
def excitation_page(found: Excitation) -> Page:
    """The whole report."""
    page = Page(f"Motion that separates: {found.group.name}")
    hopeful = [row for row in found.table if not row.hopeless]
    page.answer(_sentence(found, len(hopeful)), "note" if found.open else "good", _facts(found))
    page.heading("The motion")
    motion = found.trajectory()
    view = ArmView(
        found.robot,
        motion.time,
        motion.q,
        draw.colourings(motion, found.robot, found.robot.tau_max),
    )
    page.arm(view, "Run it in a free cell: nothing around the arm is known here.")
    page.heading("What it tells apart")
    if hopeful:
        page.figure(
            separation_figure(found),
            f"Separation of each pair; above {CLEAR:g} (dashed) a log tells them apart.",
        )
    page.table("Separation in standard deviations of the assumed noise", *rows(found))
    for row in found.inseparable:
        page.finding(f"{row.pair}: {row.reason}; a record of any length shows {row.ceiling:.1f}.")
    if found.inseparable or found.open:
        page.text(f"Measure besides: {found.group.measure_else}.")
    page.heading("Each joint")
    add_joints(page, found.robot, motion)
    return page


def rows(found: Excitation) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a pair a row."""
    head = ["pair", "standard motion", "this motion", "verdict"]
    return head, [
        [row.pair, float(row.distance[0]), float(row.distance[1]), row.verdict]
        for row in found.table
    ]


def separation_figure(found: Excitation) -> Figure:
    """A pair of bars for each two effects."""
    shown = sorted((r for r in found.table if not r.hopeless), key=lambda r: r.distance[1])[:MOST]
    figure, axis = wide(1.4 + 0.3 * len(shown))
    place = np.arange(len(shown))
    for shift, which, colour, label in (
        (0.2, 0, "tab:gray", "standard motion"),
        (-0.2, 1, "tab:blue", "this motion"),
    ):
        values = [max(r.distance[which], 1e-2) for r in shown]
        axis.barh(place + shift, values, 0.4, color=colour, label=label)
    axis.axvline(CLEAR, color="tab:red", ls="--", lw=0.9)
    axis.set_yticks(place, [r.pair for r in shown], fontsize="small")
    logarithmic(axis, "x")
    axis.set(xlabel="separation [standard deviations]")
    axis.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), frameon=False, ncols=2)
    return figure


def _sentence(found: Excitation, hopeful: int) -> str:
    apart = sum(row.separated for row in found.table if not row.hopeless)
    text = f"A log of this motion tells {apart} of {hopeful} pairs of effects apart"
    beside = len(found.inseparable)
    return f"{text}; {beside} no motion can." if beside else f"{text}."


def _facts(found: Excitation) -> list[tuple[str, str]]:
    return [
        ("duration", f"{found.course.duration:.1f} s"),
        ("torque, at most", of_limit(found.extent.torque)),
        ("speed, at most", of_limit(found.extent.speed)),
        ("acceleration, at most", of_limit(found.extent.acceleration)),
        ("from the ends of the range kept", f"{np.degrees(found.extent.box):.0f} deg"),
    ]
