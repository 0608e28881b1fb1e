"""What an effect does to the torque of a joint, on one motion that every effect is shown on."""

from __future__ import annotations

from functools import cache

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects.registry import effect_class
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.report.elements.plots import wide
from irb2400_ctrl.robot import Robot, load_robot
from irb2400_ctrl.trajectory.trajectory import RATE

SECONDS = 20.0
JOINTS = (2, 4, 5, 1, 3, 6)
"""in this order the first that an effect can sit on"""
SIGNALS = {
    "q": ("angle", "deg"),
    "qd": ("speed", "deg/s"),
    "qdd": ("acceleration", "deg/s2"),
    "load": ("torque without it", "Nm"),
    "time": ("time", "s"),
}


def effect_figure(kind: str) -> tuple[Figure, int]:
    """What it adds to the torque of the IRB 2400, in the size of its example: over time, and over
    the signal that orders it best; with the joint, counted from 1.

    Raises:
        InputError: no such kind.
    """
    robot, motion, without = _shown_motion()
    added, own = _added(kind, robot, motion, without)
    joint = own or int(np.argmax(np.std(added, axis=0))) + 1
    values = np.where(motion.known[:, joint - 1], added[:, joint - 1], np.nan)
    signal = effect_class(kind).drawing.abscissa
    figure, _ = wide(2.8)
    figure.clear()
    left, right = figure.subplots(1, 2, sharey=True)
    time = motion.time - motion.time[0]
    left.plot(time, values, color="tab:blue", lw=0.9)
    left.set(xlabel="time [s]", ylabel=f"added to torque {joint} [Nm]", xlim=(time[0], time[-1]))
    ordered = "load" if signal == "time" else signal
    right.plot(_signal(ordered, motion, without, joint - 1), values, color="tab:blue", lw=0.6)
    name, unit = SIGNALS[ordered]
    right.set(xlabel=f"{name} {joint} [{unit}]")
    low = float(np.nanmin(values))
    high = float(np.nanmax(values))
    if high - low < 1e-6 * max(abs(high), abs(low)):  # a constant needs an axis with zero in it
        left.set_ylim(min(0.0, 1.5 * low), max(0.0, 1.5 * high))
    for axis in (left, right):
        axis.grid(lw=0.6)
    return figure, joint


def _added(
    kind: str, robot: Robot, motion: PreparedLog, without: Array
) -> tuple[Array, int | None]:
    """The torque with the effect less that without, (m, n), and the joint it sits on."""
    family = effect_class(kind)
    possible = list(family.joints(robot.n))
    joint = next((j for j in JOINTS if j in possible), possible[0])
    mass = Model(robot).mass_matrix(motion.q[0])
    inertia = 0.0 if joint is None else float(mass[joint - 1, joint - 1])
    effect = family.representative(joint, inertia, SECONDS)
    return predicted_torque(robot.with_effects(effect), motion) - without, joint


def _signal(name: str, motion: PreparedLog, without: Array, j: int) -> Array:
    if name == "load":
        return np.asarray(without[:, j])
    return np.degrees({"q": motion.q, "qd": motion.qd, "qdd": motion.qdd}[name][:, j])


@cache
def _shown_motion() -> tuple[Robot, PreparedLog, Array]:
    """All joints back and forth, each at its own pace, and the torque without any effect."""
    robot = load_robot("irb2400")
    time = np.arange(round(SECONDS * RATE)) / RATE
    pace = 2.0 * np.pi * np.array([0.11, 0.13, 0.17, 0.19, 0.23, 0.29])
    reach = np.radians([50.0, 30.0, 25.0, 60.0, 50.0, 80.0])
    q = reach * np.sin(time[:, None] * pace + np.arange(6)) + np.radians([0, 10, 5, 0, 30, 0])
    tau = np.asarray(Model(robot).gravity(q))
    motion = prepare(Log(time, q, tau, name="shown"))
    return robot, motion, predicted_torque(robot, motion)
