"""Elastic transmissions with motor and link apart: which joints, and their numbers.

A joint with effects in its transmission (`elastic_joint`, `transmission_backlash`) has two angles,
that of its motor q and that of its link l:

    J qdd_motor + friction = tau - s,    s = (k / a) sinh(a dead(q - l)) + d (qd - ld) in contact,
    drives the link,

dead(x) = x - clamp(x, -gap/2, gap/2), a the stiffening (0: k dead(q - l)), J the rotor's inertia
reflected to the joint (`rotor_inertia` on that joint). Encoder, controller and dry friction are on
the motor's side; the tool hangs on the link's.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.transmission import wound
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.model import Model
from irb2400_ctrl.robot import Robot

ROTOR_SHARE = 0.1
"""assumption where a robot names an elastic joint but no rotor inertia: this share of the axis'
inertia in the home pose; not published for this robot"""
TEETH_Hz = 40.0
TEETH_DAMPING = 0.1
"""assumption where a robot names backlash but no elasticity: the link on the stiffness of its
teeth, motor held"""


def elastic_joints(robot: Robot) -> tuple[int, ...]:
    """Zero-based numbers of the joints with a transmission of their own, in order."""
    joints = set[int]()
    effects = _in_transmissions(robot)
    for kind in dict.fromkeys(effect.kind for effect in effects):
        found = [effect.index for effect in effects if effect.kind == kind]
        if len(set(found)) != len(found):
            raise InputError(
                f"joint {1 + max(found, key=found.count)} has two {kind} effects; expected one"
            )
        joints |= set(found)
    return tuple(sorted(joints))


def elastic_data(robot: Robot) -> Array:
    """Stiffness [Nm/rad], damping [Nm s/rad], rotor inertia [kg m2], gap [rad] and stiffening
    [1/rad] of each such joint, shape (k, 5)."""
    rows = []
    for j in elastic_joints(robot):
        found = [e.transmission() for e in _in_transmissions(robot) if e.index == j]
        rotors = [e.motor_inertia for e in robot.effects if e.joint == j + 1]
        own = [inertia for inertia in rotors if inertia is not None]
        # the damping ratio is that of the link on its spring, the motor held
        link = float(Model(robot.bare()).mass_matrix(np.zeros(robot.n))[j, j])
        inertia = sum(float(i) for i in own) if own else ROTOR_SHARE * link
        stiffness = _said([t.stiffness for t in found], link * (2 * np.pi * TEETH_Hz) ** 2)
        ratio = _said([t.damping for t in found], TEETH_DAMPING)
        gap = _said([t.gap for t in found], 0.0)
        stiffening = _said([t.stiffening for t in found], 0.0)
        damping = 2 * ratio * np.sqrt(stiffness * link)
        rows.append([stiffness, damping, inertia, gap, stiffening])
    return np.array(rows, dtype=float).reshape(-1, 5)


def twist(load: Array, data: Array) -> Array:
    """q - l at rest under the loads [Nm] of the elastic joints, shape (k,) [rad]."""
    wound_up = wound(ca.DM(load), ca.DM(data[:, 0]), ca.DM(data[:, 4]))
    return np.asarray(wound_up).ravel() + 0.5 * data[:, 3] * np.sign(load)


def links_only(robot: Robot) -> Robot:
    """The robot without its springs and the rotors behind them: what the springs drive."""
    soft = elastic_joints(robot)
    kept = tuple(
        e
        for e in robot.effects
        if e.acts != "transmission" and not (e.motor_inertia is not None and e.index in soft)
    )
    return robot.model_copy(update={"effects": kept})


def rigid(robot: Robot) -> Robot:
    """The robot as a controller takes it: no joint has a spring or play."""
    kept = tuple(e for e in robot.effects if e.acts != "transmission")
    return robot.model_copy(update={"effects": kept})


def _in_transmissions(robot: Robot) -> list[Effect]:
    return [effect for effect in robot.effects if effect.acts == "transmission"]


def _said(values: Sequence[float | None], otherwise: float) -> float:
    """The first value that an effect says, or what is assumed where none does."""
    return next((value for value in values if value is not None), otherwise)
