"""Friction of a joint whose motor other axes turn: what it changes by, all of them feel."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.geared_motor import GearedMotor, along
from irb2400_ctrl.measurement.motion.standstill import slow
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot


@dataclass(frozen=True)
class TurnedMotors:
    """Motors of `geared_motor`, and the share of their joints' friction that is theirs.

    A gear that is stiffer by a tenth today is so at the speed of its motor: without this, the
    friction of another day looks like axes that drag each other's motors.

    Args:
        motors: with the shares of dry and of viscous friction, at most one each.
    """

    motors: tuple[tuple[GearedMotor, float, float], ...]

    @classmethod
    def of(cls, robot: Robot) -> TurnedMotors:
        """Those of a robot that lasts."""
        found = []
        for effect in robot.effects:
            if isinstance(effect, GearedMotor):
                _, dry, viscous, _ = robot.friction[effect.index]
                share = _share(effect.coulomb_Nm, dry), _share(effect.viscous_Nms_rad, viscous)
                found.append((effect, *share))
        return cls(tuple(found))

    def columns(self, qd: Array) -> Iterator[tuple[int, int, Array]]:
        """(0 for dry, 1 for viscous; zero-based joint; torque (m, n) [Nm]) per unit of the joint's
        friction, beside what acts on the joint alone.

        Args:
            qd: [rad/s], shape (m, n).
        """
        for motor, dry, viscous in self.motors:
            # inertia asks for accelerations, and friction does not
            torques = along((qd, np.zeros_like(qd)), motor.turns(qd.shape[1]), motor.index)
            yield 0, motor.index, dry * torques[:, :, 2]
            yield 1, motor.index, viscous * torques[:, :, 1]

    def updated(self, robot: Robot, dry: Array, viscous: Array) -> Robot:
        """The robot whose motors have their share of a change of friction.

        Args:
            robot: with the friction of its joints changed.
            dry: by how much [Nm], shape (n,).
            viscous: [Nm s/rad], shape (n,).
        """
        if not self.motors:
            return robot
        changed = {
            id(motor): motor.model_copy(
                update={
                    "coulomb_Nm": motor.coulomb_Nm + of_dry * float(dry[motor.index]),
                    "viscous_Nms_rad": motor.viscous_Nms_rad
                    + of_viscous * float(viscous[motor.index]),
                }
            )
            for motor, of_dry, of_viscous in self.motors
        }
        effects = tuple(changed.get(id(effect), effect) for effect in robot.effects)
        return robot.model_copy(update={"effects": effects})


def with_turning_motors(robot: Robot, motion: PreparedLog) -> PreparedLog:
    """The motion without the torques of all joints that feel a motor where that turns or rests.

    Joints that move may hold a motor still between them; then its dry friction is undetermined, and
    it turns over in no column of theirs.

    Args:
        robot: whose motors they are; motion: the log, prepared.
    """
    motors = [effect for effect in robot.effects if isinstance(effect, GearedMotor)]
    if not motors:
        return motion
    unknown = np.zeros(motion.qd.shape, dtype=bool)
    for motor in motors:
        turns = np.array(motor.turns(motion.n))
        unknown |= np.outer(slow(motion.qd @ turns, motion.step), turns != 0.0)
    return motion.without(unknown)


def _share(of_motor: float, of_joint: float) -> float:
    return float(np.clip(of_motor / of_joint, 0.0, 1.0)) if of_joint > 0.0 else 0.0
