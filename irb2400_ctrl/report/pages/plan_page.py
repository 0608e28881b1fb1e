"""The report of a planned motion: of one operation, or of a whole program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irb2400_ctrl.cell import Cell
from irb2400_ctrl.cell.description import CellTool
from irb2400_ctrl.planners import Plan, ProgramMotion
from irb2400_ctrl.report.elements.arm_view import ArmView
from irb2400_ctrl.report.elements.page import Page, of_limit
from irb2400_ctrl.report.figures import plan_figures as draw
from irb2400_ctrl.report.figures.rotation_figure import rotation_figure
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

# a bound is a little above what is reached, and rows cut corners anew
_CLEARLY = 1.1
LEAST_TURN_DEG = 1e-3
"""turns of the tool below this are the rounding of CAM files"""


@typed
def plan_page(
    found: Plan | ProgramMotion,
    title: str,
    robot: Robot | None = None,
    cell: Cell | None = None,
    tool: CellTool | None = None,
    tolerance: float | None = None,
) -> Page:
    """The whole report.

    Args:
        found: the plan.
        title: of the page.
        robot: the arm with the TCP of its file, where a cell's tool takes its place.
        cell: what stands around the arm.
        tool: of the cell, in the spindle.
        tolerance: how far corners might be cut [m]; None where nobody said.
    """
    page = Page(title)
    summary = found.summary()
    page.answer(sentence(summary), "good" if summary["guaranteed"] else "note", facts(summary))
    if tolerance is not None and (said := deviation_words(summary, tolerance)):
        page.finding(f"{said[0].upper()}{said[1:]}.")
    if said := turned_words(summary):
        page.finding(f"{said[0].upper()}{said[1:]}.")
    add_plan(page, found, robot, cell, tool)
    return page


def add_plan(
    page: Page,
    found: Plan | ProgramMotion,
    robot: Robot | None = None,
    cell: Cell | None = None,
    tool: CellTool | None = None,
) -> None:
    """Sections of a plan: arm, feed, torque, margins, numbers."""
    plan = found if isinstance(found, Plan) else None
    plans = [found] if isinstance(found, Plan) else found.plans
    one = plans[0]
    summary = found.summary()
    limits = summary["torque_share"] * one.robot.tau_max
    motion = found.trajectory
    page.heading("The motion")
    view = ArmView(
        robot or one.robot,
        motion.time,
        motion.q,
        draw.colourings(motion, one.robot, limits, draw.programmed_feed(plans)),
        cell,
        tool,
        external=None if motion.external is None else motion.external.q,
    )
    page.arm(view, "The arm along the way; the body of the arm is the outline of its robot file.")
    if isinstance(found, ProgramMotion):
        _add_program(page, summary)
    _add_feed(page, found, plan, summary["feed"])
    page.heading("Torque, speed and angles")
    drawn = draw.torque_figures(motion, limits)
    page.figures(drawn, "Torque of each joint; limits are dashed.", zoomable=True)
    drawn = draw.speed_figures(motion, one.robot)
    page.figures(drawn, "Speed of each joint; limits are dashed.", zoomable=True)
    drawn = draw.angle_figures(motion, one.robot)
    page.figures(drawn, "Angle of each joint; ends of its range are dashed.", zoomable=True)
    turned = draw.external_figures(motion)
    if turned:
        page.figures(turned, "Where the carriage and the positioner are, as far as they move.")
    page.heading("Distance from the singularities")
    drawn = draw.margin_figures(motion, one.robot, summary["singularity_margin"])
    page.figures(
        drawn,
        "Margins to wrist singularity, shoulder singularity and elbow singularity; the smallest "
        "over the continuous path is dashed.",
        zoomable=True,
    )
    if plan is not None and plan.rotation_map is not None:
        page.heading("Other tool rotations")
        page.figure(
            rotation_figure(plan.rotation_map),
            "What every tool rotation would meet along the way; the line is the one chosen.",
        )
    page.heading("The plan in numbers")
    page.table("Bounds hold over all times, not only at the rows", *numbers(summary))
    if plan is not None and plan.alternatives:
        _add_compared(page, summary)


def sentence(summary: Mapping[str, Any]) -> str:
    """The verdict."""
    feed = summary["feed"]
    told = f"The way can be driven in {summary['duration_s']:.2f} s"
    if feed is not None:
        told += f", at the programmed feed on {100 * feed['share_at_feed']:.1f} % of it"
    if summary["guaranteed"]:
        return f"{told}; no torque passes its limit at any instant (guaranteed)."
    note = summary["guarantee_note"]
    return f"{told}; the torque bound is not guaranteed" + (f": {note}." if note else ".")


def deviation_words(summary: Mapping[str, Any], tolerance: float) -> str | None:
    """How far the rows leave the path, where that is clearly more than was asked for [m]."""
    most = summary["max_tcp_deviation_mm"]
    if most <= _CLEARLY * 1e3 * tolerance:
        return None
    linear = summary["interpolation"] == "linear"
    why = "; straight between rows the TCP cuts curves" if linear else ""
    return (
        f"the TCP leaves the path by up to {most:.3f} mm, {1e3 * tolerance:g} mm were asked for"
        f"{why}; nearer with a smaller --tolerance-mm (more of its bends then count as corners), "
        "more rows (--rate) or a lower feed"
    )


def turned_words(summary: Mapping[str, Any]) -> str | None:
    """Where the tool is turned from its stated orientation by more than a CAM file is written to,
    and how far."""
    turned = [p for p in summary.get("wrist_passages", ()) if p["taken"] == "through"]
    most = max(turned, key=lambda p: p["miss_deg"], default=None)
    if most is None or most["miss_deg"] < LEAST_TURN_DEG:
        return None
    return (
        f"the tool is turned by {most['miss_deg']:.2g} deg from its stated orientation at "
        f"{most['at_mm']:.0f} mm of the way, to pass the wrist singularity (--axis-tolerance-deg)"
    )


def facts(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What an engineer asks first."""
    margin = summary["singularity_margin"]
    clearance = summary["clearance_mm"]["value"]
    return [
        ("duration", f"{summary['duration_s']:.2f} s"),
        ("torque, at most", of_limit(summary["max_torque_ratio"])),
        ("speed, at most", of_limit(summary["max_velocity_ratio"])),
        *[("acceleration, at most", of_limit(bend)) for bend in _accelerations(summary)],
        ("TCP deviation, at most", f"{summary['max_tcp_deviation_mm']:.3f} mm"),
        ("clearance, at least", "not known" if clearance is None else f"{clearance:.0f} mm"),
        ("wrist margin |sin q5|", f"{margin['wrist']:.3f}"),
    ]


def numbers(summary: Mapping[str, Any]) -> tuple[list[str], list[list[object]]]:
    """Head and rows of what plan.json promises."""
    margin = summary["singularity_margin"]
    clearance = summary["clearance_mm"]
    near = clearance["value"]
    least = "not known: " + clearance["reason"] if near is None else float(near)
    where = "" if near is None else " between " + " and ".join(clearance["pair"])
    rows: list[list[object]] = [
        ["points of the path", str(summary["points"]), ""],
        ["length of the TCP's way", float(summary["length_mm"]), "mm"],
        ["duration", float(summary["duration_s"]), "s"],
        ["TCP deviation, at most", float(summary["max_tcp_deviation_mm"]), "mm"],
        ["tool axis deviation, at most", f"{summary['max_tool_axis_deviation_deg']:.4f}", "deg"],
        ["margin to the wrist singularity, |sin q5|", float(margin["wrist"]), "-"],
        ["margin to the shoulder singularity", float(margin["shoulder"]), "m"],
        ["margin to the elbow singularity", float(margin["elbow"]), "m"],
        [f"clearance, at least{where}", least, "mm" if near is not None else ""],
        ["torque, at most", f"{100 * summary['max_torque_ratio']:.1f}", "% of limit"],
        ["speed, at most", f"{100 * summary['max_velocity_ratio']:.1f}", "% of limit"],
        *_acceleration_rows(summary),
        *_external_rows(summary),
        ["rows are read as", summary["interpolation"], ""],
    ]
    return ["quantity", "value", "unit"], rows


def _accelerations(summary: Mapping[str, Any]) -> list[float]:
    """The largest over its limit; none where the robot states none."""
    found = summary["max_acceleration_ratio"]
    return [] if found is None else [found]


def _acceleration_rows(summary: Mapping[str, Any]) -> list[list[object]]:
    return [
        ["acceleration, at most", f"{100 * bend:.1f}", "% of limit"]
        for bend in _accelerations(summary)
    ]


def _external_rows(summary: Mapping[str, Any]) -> list[list[object]]:
    """Speed and acceleration of the axes that move beside the arm."""
    return [
        [f"{what} of {axis['name']}, at most", f"{100 * axis[key]:.1f}", "% of limit"]
        for axis in summary["external_axes"]
        for what, key in (
            ("speed", "max_speed_ratio"),
            ("acceleration", "max_acceleration_ratio"),
        )
    ]


def _add_feed(
    page: Page, found: Plan | ProgramMotion, plan: Plan | None, feed: Mapping[str, Any] | None
) -> None:
    page.heading("Feed")
    programmed = draw.programmed_feed([found] if isinstance(found, Plan) else found.plans)
    figure = draw.feed_figure(found.trajectory, plan, programmed)
    cut = "" if programmed is None else "; faster than the feeds of the file it is cut off"
    page.figures([figure], f"Speed of the TCP along the motion{cut}.", zoomable=True)
    if feed is None:
        page.text("The file programs no feed.")
        return
    page.text(f"The programmed feed is held on {100 * feed['share_at_feed']:.1f} % of its path.")
    below = feed.get("below_by_limit_mm", {})
    if below:
        rows: list[list[object]] = [[limit, float(length)] for limit, length in below.items()]
        page.table("What keeps the rest below the feed", ["limit", "length [mm]"], rows)


def _add_program(page: Page, summary: Mapping[str, Any]) -> None:
    """Segments and events of a whole program."""
    page.heading("Step by step")
    rows: list[list[object]] = [
        [
            s["kind"],
            str(s["operation"]),
            f"{s['start_s']:.2f}",
            f"{s['end_s'] - s['start_s']:.2f}",
        ]
        for s in summary["segments"]
    ]
    page.table("Pieces of the motion", ["piece", "operation", "from [s]", "takes [s]"], rows)
    events = [
        [e["kind"], e["text"], str(e["line"]), f"{e['time_s']:.2f}", "yes" if e["at_rest"] else ""]
        for e in summary["events"]
    ]
    if events:
        head = ["event", "text", "line", "at [s]", "arm stands"]
        page.table("What the program asks for besides motion", head, events)


def _add_compared(page: Page, summary: Mapping[str, Any]) -> None:
    rows: list[list[object]] = [
        [c["kind"], str(c["branch"]), float(c["relative_margin"]), float(c["duration_s"])]
        for c in summary["compared"]
    ]
    head = ["tool rotation", "branch", "margin over the largest [-]", "fastest [s]"]
    page.table("Ways that were compared", head, rows, folded=True)
