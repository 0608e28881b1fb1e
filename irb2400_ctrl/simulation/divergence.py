"""Why a simulated loop came to no numbers, in words."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.viscous_step import needed_substeps
from irb2400_ctrl.trajectory import Trajectory

FAR = 1e3
"""[rad] farther than this an arm has diverged"""


def check_finite(
    controller: Block, arm: Robot, substeps: int, motion: Trajectory, signals: Mapping[str, Array]
) -> None:
    """Refuse a run that came to no numbers, and say what to look at.

    Args:
        controller: that was run.
        arm: the plant.
        substeps: its time steps per control period.
        motion: the reference.
        signals: outputs of the loop by name.

    Raises:
        InputError: an output that is no number, or an arm that left its joint box by far.
    """
    lost = np.abs(signals["q"]).max(axis=1) > FAR
    for values in signals.values():
        lost |= ~np.isfinite(values).all(axis=1)
    if not lost.any():
        return
    row = int(np.argmax(lost))
    at = f"at {motion.time[row]:.3f} s"
    seen = {name: bool(np.isfinite(values[row]).all()) for name, values in signals.items()}
    if seen["q"] and seen["qd"] and seen["q_seen"] and seen["qd_seen"]:
        told = {f.name: "command" if f.name == "tau" else f"c_{f.name}" for f in controller.outputs}
        empty = [name for name, signal in told.items() if not seen[signal]]
        if empty:
            raise InputError(
                f"the controller {controller.name!r} gives no number as {empty[0]} {at}, from "
                "angles and speeds that are numbers: look for a division by zero, or a root or "
                "logarithm of what is negative"
            )
    raise InputError(
        f"the simulated arm diverged {at} under {controller.name!r}: "
        + _why(controller, arm, substeps, motion)
    )


def _why(controller: Block, arm: Robot, substeps: int, motion: Trajectory) -> str:
    """Friction that stops a joint within a time step, or gains and masses."""
    needed = needed_substeps(arm, controller.sample_time)
    if needed <= substeps:
        return "lower the gains, or check the plant's mass data"
    mobility = np.diag(np.linalg.inv(Model(arm).mass_matrix(motion.q[0])))
    viscous = arm.friction[:, 2]
    j = int(np.argmax(viscous * mobility))
    within = 1.0 / (viscous[j] * mobility[j])
    step = controller.sample_time / substeps
    return (
        f"viscous friction of {viscous[j]:.3g} Nm s/rad stops joint {j + 1}, of "
        f"{1 / mobility[j]:.2g} kg m2, within {1e6 * within:.2g} us, too fast for time steps of "
        f"{1e6 * step:.3g} us. State the inertia of its rotor "
        '(kind = "rotor_inertia" in [[effects]]), a smaller friction, or '
        f"substeps={needed} in Python"
    )
