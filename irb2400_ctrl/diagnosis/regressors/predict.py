"""What a robot's model says a log should show, effects with memory and the measuring chain
included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.regressors.bases import Bases, RegressorColumns
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.time_delay import late
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot


def predicted_torque(robot: Robot, motion: PreparedLog, bases: Bases | None = None) -> Array:
    """Torques that the log of a motion should show, shape (m, n) [Nm].

    Model torque at the true angles, plus force effects, through gain, offset and delay of the
    measuring chain and the filter of the recorder.

    Args:
        robot: with its effects.
        motion: the log, prepared.
        bases: evaluator of the robot the bases are built on; default the robot itself without its
            effects.
    """
    arm = robot.bare()
    others = [e for e in robot.effects if e.role != "parameters"]
    bases = Bases(arm) if bases is None else bases
    bodies = _further_bodies(arm, bases.robot)
    moved = _true(motion, others)
    model = Model(arm) if bodies is None else bases.model
    tau = np.array(model.inverse_dynamics(moved.q, moved.qd, moved.qdd))
    for effect in (*(bodies or ()), *others):
        if effect.chain == "torque":
            tau += effect_torque(bases, effect, moved)
    for link in ("reading", "clock"):  # the drive's reading is what arrives late
        for effect in others:
            if effect.chain == link:
                tau = effect.reported(motion.time, tau)
    return motion.as_recorded(tau)


def _true(motion: PreparedLog, effects: Sequence[Effect]) -> PreparedLog:
    """The motion that the arm has where effects falsify what the log says of its angles."""
    q, qd, qdd = (part.copy() for part in (motion.q, motion.qd, motion.qdd))
    for effect in effects:
        offset, delay = effect.angle_error
        if offset or delay:
            active = effect.active(motion.time)
            for part in (q, qd, qdd) if delay else ():
                part[active, effect.index] = late(motion.time, part[:, effect.index], -delay)[
                    active
                ]
            q[active, effect.index] += offset
    return replace(motion, q=q, qd=qd, qdd=qdd)


def _further_bodies(arm: Robot, known: Robot) -> tuple[Effect, ...] | None:
    """Bodies that an arm carries beyond those of a known one, None where it differs otherwise.

    The torque is linear in them: no model of the arm with them has to be built.
    """
    count = len(known.effects)
    if arm.model_copy(update={"effects": arm.effects[:count]}) != known:
        return None
    return tuple(arm.effects[count:])


def effect_torque(
    bases: Bases, effect: Effect, motion: PreparedLog, *, filtered: bool = False
) -> Array:
    """Torque of one effect along a motion from its basis, shape (m, n) or filtered (rows, n)
    [Nm].

    Args:
        bases: evaluator of the robot's effects.
        effect: with its numbers.
        motion: the log, prepared.
        filtered: through the motion's common filter, at its rows.
    """
    law = bases.of(effect, motion, filtered=filtered)
    tau = law.torque(np.array(effect.coefficients()), motion.n)
    if not effect.discrepancy:
        return tau
    columns = bases.of(effect, motion, discrepancy=True, filtered=filtered)
    # further columns tell how a record began: no property of the robot
    kept = RegressorColumns(columns.joints, columns.values[:, :, : len(effect.discrepancy)])
    return tau + kept.torque(np.array(effect.discrepancy), motion.n)
