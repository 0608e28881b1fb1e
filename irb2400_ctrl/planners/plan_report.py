"""`report`: a certified motion as the `Plan` that is handed out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.certify import PlanBounds
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.enclosure.tcp_path import TcpPath
from irb2400_ctrl.planners.margins_as_read import Margins
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.redundancy.cutting_load import CuttingLoad
from irb2400_ctrl.planners.redundancy.wrist_remedies import Remedy, taken
from irb2400_ctrl.planners.stage_clock import StageClock
from irb2400_ctrl.planners.timing.feed_use import feed_use
from irb2400_ctrl.planners.timing.passing_times import passing_times, point_lengths
from irb2400_ctrl.planners.timing.sampled_reference import SampledReference
from irb2400_ctrl.planners.timing.time_choices import TimedChoice
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.planners.toolpath.orientation import Orientation
from irb2400_ctrl.trajectory import Trajectory


def report(
    dynamics: PathDynamics,
    orientation: Orientation,
    timed: Sequence[TimedChoice],
    chosen: TimedChoice,
    bounds: PlanBounds,
    margins: Margins,
    remedies: Sequence[Remedy],
    options: TimingOptions,
    reference: SampledReference,
    clock: StageClock,
) -> Plan:
    """The plan of the chosen motion, with what it was compared with.

    Args:
        dynamics: the arm.
        orientation: the tool path, placed and smoothed.
        timed: all choices that were compared.
        chosen: the one that is driven.
        bounds: what is sure of it; margins: how far it stays from everything.
        remedies: of its wrist passages; options: how it was timed.
        reference: the rows of the trajectory.
        clock: of the stages; it goes on writing what they took.
    """
    path = chosen.path
    joints = bounds.joints
    trajectory, s = law_rows(dynamics, chosen.law, path.tcp, reference)
    return Plan(
        robot=dynamics.model.robot,
        path=orientation.curve.path,
        trajectory=trajectory,
        length=float(path.tcp.lengths[-1]),
        certificate=joints.certificate,
        duration=chosen.law.duration,
        guaranteed=joints.guaranteed,
        guarantee_note=joints.note,
        interpolation=reference.interpolation,
        torque_share=options.torque_share,
        rates=chosen.rates,
        timing=options.backend,
        max_tcp_deviation=bounds.deviation.largest,
        max_tool_axis_deviation=bounds.deviation.axis,
        clearance=margins.clearance,
        singularity_margin=margins.singularity,
        margins_of=margins.of,
        max_torque_ratio=joints.torque_ratio,
        max_velocity_ratio=joints.velocity_ratio,
        max_acceleration_ratio=joints.acceleration_ratio,
        max_feed_ratio=bounds.feed_ratio,
        external=joints.external,
        chosen=chosen.choice.kind,
        branch=chosen.choice.branch,
        rotation=chosen.choice.rotation(s),
        feed_use=feed_use(dynamics, orientation.curve, path, chosen.law, options.limits),
        point_times=passing_times(chosen.law, point_lengths(orientation.curve, path.followed)),
        alternatives=tuple(_compared(option) for option in timed),
        passages=tuple(_passages(chosen)),
        remedies=tuple(remedy.summary() for remedy in remedies),
        wall_time=clock.seconds,
    )


def law_rows(
    dynamics: PathDynamics, law: TimeLaw, tcp: TcpPath, reference: SampledReference
) -> tuple[Trajectory, Array]:
    """The rows with torque and the TCP's way, with the digits of the file, and where on the joint
    path they are.

    Args:
        dynamics: the arm's torque along the path.
        law: when the path is where.
        tcp: the way of the TCP.
        reference: the rows.
    """
    rows = reference.rows
    s = law.at(rows.time)[0]
    tau = dynamics.torque(rows.q, rows.qd, rows.qdd, rows.time)
    n = dynamics.model.robot.n
    found = replace(rows.apart(n), tau=tau[:, :n], s=tcp.way(s), check_speeds=False)
    return found.as_written(), s


def _compared(option: TimedChoice) -> dict[str, Any]:
    """One of the choices, for `plan.json`."""
    choice = option.choice
    told = {
        "kind": choice.kind,
        "branch": choice.branch,
        "relative_margin": float(choice.margins.min()),
        "turn_deg": float(np.degrees(choice.turn)),
        "duration_s": option.fastest.duration,
    }
    if choice.given_way is not None:
        told["deflection_mm"] = 1e3 * choice.given_way.largest
    return told


def deflection(chosen: TimedChoice, load: CuttingLoad | None) -> dict[str, Any] | None:
    """The entry `deflection` of `plan.json`; None without a cutting force."""
    found = chosen.choice.given_way
    if found is None or load is None:
        return None
    way = float(chosen.path.tcp.way(found.s))
    return {
        "largest_mm": 1e3 * found.largest,
        "at_mm": 1e3 * way,
        "mean_mm": 1e3 * found.mean,
        **load.summary(),
    }


def _passages(chosen: TimedChoice) -> list[dict[str, Any]]:
    """What is done at each passage of the wrist, placed along the TCP's way."""
    passages = []
    for passage in taken(chosen.choice):
        way = float(chosen.path.tcp.way(passage["at_mm"] / 1e3))
        passages.append({**passage, "at_mm": 1e3 * way})
    return passages
