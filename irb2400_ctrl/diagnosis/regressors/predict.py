"""What a robot's model says a log should show, effects with memory and the measuring chain
included."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.regressors.bases import Bases, RegressorColumns
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def predicted_torque(robot: Robot, motion: PreparedLog, bases: Bases | None = None) -> Array:
    """Torques that the log of a motion should show, shape (m, n) [Nm].

    Model torque at the true angles, plus force effects, through gain, offset and delay of the
    measuring chain.

    Args:
        bases: evaluator of the robot the bases are built on; default the robot itself without its
            effects.
    """
    arm = robot.bare()
    others = [e for e in robot.effects if e.role != "parameters"]
    q = motion.q.copy()
    for effect in others:
        if effect.chain == "angle":
            q[effect.active(motion.time), effect.index] += effect.angle_offset
    bases = Bases(arm) if bases is None else bases
    model = bases.model if bases.robot == arm else Model(arm)
    tau = np.array(model.inverse_dynamics(q, motion.qd, motion.qdd))
    moved = replace(motion, q=q)
    for effect in others:
        if effect.chain == "torque":
            tau += effect_torque(bases, effect, moved)
    for link in ("reading", "clock"):  # the drive's reading is what arrives late
        for effect in others:
            if effect.chain == link:
                tau = effect.reported(motion.time, tau)
    return tau


def effect_torque(
    bases: Bases, effect: Effect, motion: PreparedLog, *, filtered: bool = False
) -> Array:
    """Torque of one effect along a motion from its basis, shape (m, n) or filtered (rows, n)
    [Nm]."""
    law = bases.columns(
        effect.kind,
        effect.joint,
        motion,
        [effect.nonlinear],
        filtered=filtered,
        windows=effect.windows_s,
    )[0]
    tau = law.torque(np.array(effect.coefficients()), motion.n)
    if not effect.discrepancy:
        return tau
    columns = bases.columns(
        effect.kind,
        effect.joint,
        motion,
        [effect.nonlinear],
        discrepancy=True,
        filtered=filtered,
        windows=effect.windows_s,
    )[0]
    # further columns tell how a record began: no property of the robot
    kept = RegressorColumns(columns.joints, columns.values[:, :, : len(effect.discrepancy)])
    return tau + kept.torque(np.array(effect.discrepancy), motion.n)
