"""Every bound that a simulated motion reached, so that none is reached in silence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.reference_check import outside_box, too_fast
from irb2400_ctrl.trajectory import Trajectory


def bounds_reached(
    robot: Robot,
    plant: Robot,
    reference: Trajectory,
    signals: Mapping[str, Array],
    controller: Block,
) -> dict[str, Any]:
    """Axes count from 1; empty lists, 0 and None where nothing was reached.

    Args:
        robot: as the controller knows it.
        plant: as it is.
        reference: that was asked for.
        signals: of the run by name, a row a sample.
        controller: with its gains as defaults.
    """
    brake = signals.get("c_brake")
    closed = None
    far: list[int] = []
    if brake is not None and brake.any():
        row = int(np.argmax(brake > 0))
        closed = float(reference.time[row])
        # of a guard: farther from the reference it closes the brake [rad]
        for limit in (f.start for f in controller.parameters if f.name == "error_limit"):
            far = _left(np.abs(signals["q_seen"] - reference.q) > limit, row)
    return {
        "reference_outside_joint_box": outside_box(robot, reference.q),
        "reference_above_speed_limit": too_fast(robot, reference.qd),
        "joint_box": outside_box(plant, signals["q"]),
        "speed_limit": too_fast(plant, signals["qd"]),
        "torque_limit": _axes(at_torque_limit(robot, plant, signals, controller)),
        "end_stop": _axes(np.not_equal(signals["end_stop"], 0)),
        "samples_refused_by_package": int(signals["fault"].sum()),
        "brake_closed_s": closed,
        "brake_closed_far_from_reference": far,
    }


def at_torque_limit(
    robot: Robot, plant: Robot, signals: Mapping[str, Array], controller: Block
) -> Mask:
    """Where a torque is cut, by the controller at the limit that it knows or at the bounds of its
    torque, or by the drive at its own, shape (m, n); behind a lag the torque that acts may not get
    there.

    Args:
        robot: as the controller knows it.
        plant: as it is.
        signals: of the run by name, a row a sample.
        controller: with its gains as defaults.
    """
    limit = np.fmin(robot.tau_bound, plant.tau_bound) * (1 - 1e-9)
    command = signals["command"]
    low, high = _sent(controller)
    asked = (np.abs(command) >= limit) | (command >= high) | (command <= low)
    if "c_brake" in signals:
        asked &= signals["c_brake"] == 0
    return np.asarray(asked | (np.abs(signals["tau"]) >= limit))


def _sent(controller: Block) -> tuple[Array, Array]:
    """Least and largest torque that the package sends, less its rounding."""
    tau = next(f for f in controller.outputs if f.name == "tau")
    if row := controller.own_limit(tau):
        return -row.start * (1 - 1e-9), row.start * (1 - 1e-9)
    low = np.array(tau.lower or (-np.inf,))
    high = np.array(tau.upper or (np.inf,))
    return low * (1 + 1e-9 * np.sign(low)), high * (1 - 1e-9 * np.sign(high))


def in_words(reached: dict[str, Any]) -> list[str]:
    """One line for each bound that was reached."""
    says = {
        "reference_outside_joint_box": "the reference leaves the joint box on axis",
        "reference_above_speed_limit": "the reference is faster than the limit of axis",
        "joint_box": "the arm leaves the joint box on axis",
        "speed_limit": "the arm is faster than the limit of axis",
        "torque_limit": "the torque limit is reached on axis",
        "end_stop": "the end stop is hit on axis",
        "samples_refused_by_package": "samples that the C package refuses (FAULT_INPUT):",
        "brake_closed_s": "the guard closes the brake (an input at fault, or an effect that the "
        "controller's robot lacks, such as friction that its file leaves out, or a torque that "
        "changes faster than the guard's torque_rate; --bare: no guard) at [s]",
        "brake_closed_far_from_reference": "why: farther from the reference than the guard's "
        "error_limit is axis",
    }
    lines = []
    for name, value in reached.items():
        if value or (name == "brake_closed_s" and value is not None):
            shown = ", ".join(str(v) for v in value) if isinstance(value, list) else str(value)
            lines.append(f"{says[name]} {shown}")
    return lines


def _left(far: Mask, row: int) -> list[int]:
    """Axes that were near until a row and are far from it on."""
    before = far[max(row - 1, 0)] & (row > 0)
    return [int(j) + 1 for j in np.flatnonzero(far[row] & ~before)]


def _axes(reached: Mask) -> list[int]:
    return [int(j) + 1 for j in np.flatnonzero(np.asarray(reached).any(axis=0))]
