"""The report of a place: of a part before the arm, or of the arm on its rail."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irb2400_ctrl.cell import Cell
from irb2400_ctrl.planners.placement import Outlook, Placement, Proof, RailPosition
from irb2400_ctrl.planners.redundancy.comfort import COMFORTABLE_MARGINS, comfortable
from irb2400_ctrl.report.elements.arm_view import ArmView
from irb2400_ctrl.report.elements.page import Grade, Page
from irb2400_ctrl.report.figures.placement_figure import (
    NAMES,
    at_points,
    map_figure,
    margin_figure,
    rail_figure,
)
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

SHOWN_SPEED = 0.1
"""of the tip in the picture, which is not timed yet [m/s]"""


@typed
def placement_page(
    found: Placement, planned: Mapping[str, Any] | None = None, cell: Cell | None = None
) -> Page:
    """The whole report.

    Args:
        found: start and found place, and every place that was looked at.
        planned: what planning at both places gave, under "start" and "found".
        cell: what stands around the arm.
    """
    page = Page(f"Where to put {', '.join(found.parts)}")
    x, y, z, rx, ry, rz = (f"{v:g}" for v in found.found.summary()["work_frame"])
    page.answer(
        f"{_sentence(found.found, found.proof)} The part's frame stands at x {x}, y {y}, z {z} mm, "
        f"turned by {rx}, {ry}, {rz} deg.",
        *_judged(found),
    )
    page.text(f"To plan there: --work-frame={x},{y},{z},{rx},{ry},{rz}")
    page.heading("The area")
    page.figures(
        [map_figure(found, 1), map_figure(found, 2)],
        "From above and from the side; each square shows the best over what is not drawn.",
    )
    around = None if cell is None else cell.placed(found.found.X_BW)
    _add_place(page, found.robot, around, found)
    if planned is not None:
        _add_planned(page, planned)
    return page


@typed
def rail_page(found: RailPosition, robot: Robot, cell: Cell) -> Page:
    """The whole report of a carriage's place on its rail.

    Args:
        found: the place and its margins; robot: the arm; cell: with the carriage there.
    """
    page = Page(f"Where {robot.name} stands on its rail")
    page.answer(
        f"{_sentence(found.found, found.proof)} The carriage stands at {found.position_mm:g} mm: "
        f"[rail] position_mm = {found.position_mm:g} in the cell file.",
        *_judged(found),
    )
    page.heading("Along the rail")
    page.figures([rail_figure(found)], "The worst margin over the place of the carriage.")
    around = cell.on_rail(found.position_mm)
    _add_place(page, robot, around, found)
    return page


def _tight(proof: Proof) -> list[str]:
    """Margins that are less than comfortable somewhere between the points looked at."""
    return [
        f"the {_name(key)} is down to {value:.3g}{_unit(key)} ({comfortable(key):g} is comfortable)"
        for key, value in proof.margins.items()
        if value < comfortable(key)
    ]


def _sentence(found: Outlook, proof: Proof) -> str:
    """How good the found place is."""
    told = "Every margin is comfortable"
    if found.worth < 1.0:
        part = f"{100 * found.worth:.0f} % of what is comfortable"
        told = f"The worst margin, {_name(found.worst)}, is {part}"
    tight = _tight(proof)
    between = f" at the points looked at; between them {', '.join(tight)}" if tight else ""
    return f"{told}{between}."


def _judged(place: Placement | RailPosition) -> tuple[Grade, list[tuple[str, str]]]:
    """The colour of the answer and the facts beside it."""
    start = place.start
    found = place.found
    before = start.refused or f"{100 * start.worth:.0f} % ({_name(start.worst)})"
    now = f"{100 * found.worth:.0f} % ({_name(found.worst)})"
    facts = [
        ("worst margin at the start, of what is comfortable", before),
        ("worst margin now", now),
    ]
    if found.deflection is not None:
        facts.append(("the tip gives way by", f"{1e3 * found.deflection:.3f} mm"))
    facts.append(("places looked at", str(len(place.seen))))
    return ("note" if found.worth < 1.0 or _tight(place.proof) else "good"), facts


def _name(margin: str) -> str:
    return NAMES[margin].partition(" [")[0]


def _unit(margin: str) -> str:
    """After a number; empty where it has none."""
    unit = NAMES[margin].partition(" [")[2].rstrip("]")
    return "" if unit == "-" else f" {unit}"


def _add_place(
    page: Page, robot: Robot, cell: Cell | None, place: Placement | RailPosition
) -> None:
    """Margins of the start and of the found place, and the arm there."""
    start = place.start
    found = place.found
    proof = place.proof
    page.heading("Margins")
    page.figures(
        [margin_figure(start, found)],
        "Smallest margins at points along the path, as parts of what is comfortable; more than "
        "that is drawn as 1.",
    )
    names = [name for name in COMFORTABLE_MARGINS if name in found.margins]
    rows: list[list[object]] = [
        [
            NAMES[k],
            at_points(k, start.margins.get(k)),
            at_points(k, found.margins[k]),
            float(COMFORTABLE_MARGINS[k]),
        ]
        for k in names
    ]
    page.table(
        "Smallest margins at points along the path",
        ["margin", "start", "found", "comfortable"],
        rows,
    )
    followed: list[list[object]] = [
        [NAMES[k], float(v), comfortable(k)] for k, v in proof.margins.items()
    ]
    page.table(
        "The joint path at the found place, also between those points",
        ["margin", "at least", "comfortable"],
        followed,
    )
    if proof.way is None:
        return
    page.heading("The arm there")
    s, q = proof.way
    page.arm(
        ArmView(robot, (s - s[0]) / SHOWN_SPEED, q, cell=cell),
        f"The first operation at {1e3 * SHOWN_SPEED:.0f} mm/s of the tip; not timed yet.",
    )


def _add_planned(page: Page, planned: Mapping[str, Any]) -> None:
    page.heading("Planned at both places")
    rows: list[list[object]] = []
    for key, name, unit in (
        ("duration_s", "duration", "s"),
        ("max_torque_ratio", "torque over its limit, at most", "-"),
        ("max_velocity_ratio", "speed over its limit, at most", "-"),
        ("clearance_mm", "clearance, at least", "mm"),
        ("deflection_mm", "the tip gives way by", "mm"),
    ):
        values = [planned[at].get(key) for at in ("start", "found")]
        if any(value is not None for value in values):
            told = ["-" if value is None else float(np.float64(value)) for value in values]
            rows.append([name, *told, unit])
    for key in NAMES:
        values = [(planned[at].get("margins") or {}).get(key) for at in ("start", "found")]
        if any(value is not None for value in values):
            told = ["-" if value is None else value for value in values]
            rows.append([_name(key), *told, _unit(key).strip() or "-"])
    page.table("Start and found", ["quantity", "start", "found", "unit"], rows)
    page.text(
        "Of ways that are alike in comfort the quickest is planned, under a cutting force the one "
        "that gives way least: it may be another than the one judged above."
    )
    for at in ("start", "found"):
        if planned[at]["refused"]:
            page.finding(f"No plan at the {at}: {planned[at]['refused']}")
