"""The report of a motion in closed loop."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irb2400_ctrl.report.elements.arm_view import ArmView, Colouring
from irb2400_ctrl.report.elements.page import Page, of_limit
from irb2400_ctrl.report.elements.provenance import effects_in_words
from irb2400_ctrl.report.figures.simulation_figures import (
    error_figures,
    torque_figures,
    tracking_figure,
)
from irb2400_ctrl.simulation import Simulation
from irb2400_ctrl.simulation.bounds_reached import in_words
from irb2400_ctrl.typed import typed


@typed
def simulation_page(run: Simulation, name: str) -> Page:
    """The whole report."""
    summary = run.summary()
    page = Page(f"{name} on {run.plant.name}")
    reached = in_words(summary["bounds_reached"])
    page.answer(_sentence(summary, reached), "bad" if reached else "good", _facts(summary))
    page.heading("The motion")
    page.arm(
        arm_view(run), "The arm as simulated; the thin line is the way that was asked of the TCP."
    )
    page.heading("Distance from the reference")
    page.figure(tracking_figure({name: run}), "TCP from where it should be at that time.", True)
    page.figures(error_figures(run), "Angle less reference, joint by joint.", zoomable=True)
    page.heading("Torque")
    page.figures(torque_figures(run), "Torque that acts; limits are dashed.", zoomable=True)
    page.heading("In numbers")
    page.table("Tracking and torque of each joint", *joint_rows(summary))
    page.table("How it was measured and driven", ("setting", "value"), _settings(run, summary))
    return page


def arm_view(run: Simulation) -> ArmView:
    """The simulated arm, its way coloured by the errors and the torque."""
    colours = [
        Colouring("TCP error", "mm", 1e3 * run.tcp_error, 3),
        Colouring("contour error", "mm", 1e3 * run.contour_error, 3),
    ]
    limit = run.plant.tau_bound
    if np.isfinite(limit).any():
        share = 100 * np.abs(run.tau / limit).max(axis=1)
        colours.append(Colouring("torque share", "%", share))
    return ArmView(
        run.plant, run.time, run.signals["q_link"], tuple(colours), reference=run.p_BT_ref
    )


def joint_rows(summary: Mapping[str, Any]) -> tuple[list[str], list[list[object]]]:
    """Head and rows: a joint a row."""
    head = ["joint", "error rms [mdeg]", "error max [mdeg]", "torque over limit, max [%]"]
    head.append("at the limit [% of the time]")
    error = summary["joint_error_deg"]
    columns = zip(
        error["rms"],
        error["max"],
        summary["max_torque_ratio"],
        summary["saturated_share"],
        strict=True,
    )
    rows: list[list[object]] = [
        [str(j), 1e3 * float(rms), 1e3 * float(most), _percent(torque), 100 * float(share)]
        for j, (rms, most, torque, share) in enumerate(columns, start=1)
    ]
    return head, rows


def _percent(ratio: float | None) -> object:
    return "limit unknown" if ratio is None else 100 * ratio


def _sentence(summary: Mapping[str, Any], reached: list[str]) -> str:
    error = summary["tcp_error_mm"]
    contour = summary["contour_error_mm"]
    text = f"{summary['controller']} keeps the TCP within {error['max']:.3f} mm of its reference"
    text += f" and within {contour['max']:.3f} mm of the path"
    return f"{text}, but {'; '.join(reached)}." if reached else f"{text}."


def _plainly(value: object) -> object:
    return ("yes" if value else "no") if isinstance(value, bool) else value


def _facts(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    known = [ratio for ratio in summary["max_torque_ratio"] if ratio is not None]
    error = summary["tcp_error_mm"]
    contour = summary["contour_error_mm"]
    return [
        ("TCP error, rms", f"{error['rms']:.3f} mm"),
        ("TCP error, max", f"{error['max']:.3f} mm"),
        ("contour error, rms", f"{contour['rms']:.3f} mm"),
        ("contour error, max", f"{contour['max']:.3f} mm"),
        ("torque, at most", of_limit(max(known)) if known else "limits unknown"),
        ("duration", f"{summary['duration_s']:.2f} s"),
    ]


def _settings(run: Simulation, summary: Mapping[str, Any]) -> list[list[object]]:
    rows: list[list[object]] = [
        ["robot of the controller", summary["robot"]],
        ["plant", summary["plant"]],
        ["effects of the plant", effects_in_words(run.plant)],
        ["control rate [Hz]", f"{summary['control_rate_Hz']:.0f}"],
    ]
    for group in ("sensors", "actuators"):
        rows += [[f"{group}: {name}", _plainly(value)] for name, value in summary[group].items()]
    return [*rows, ["seed", str(summary["seed"])]]
