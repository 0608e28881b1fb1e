"""Elastic transmissions with motor and link apart: which joints, and their numbers.

A joint with an `elastic_joint` or a `transmission_backlash` effect has two angles, that of its
motor q and that of its link l:

    J qdd_motor + friction = tau - s,    s = k dead(q - l) + d (qd - ld) in contact, drives the
    link,

dead(x) = x - clamp(x, -gap/2, gap/2), J the rotor's inertia reflected to the joint (`rotor_inertia`
on that joint). Encoder, controller and dry friction are on the motor's side; the tool hangs on the
link's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.model import Model
from irb2400_ctrl.robot import Robot

Array = NDArray[np.float64]

TRANSMISSIONS = ("elastic_joint", "transmission_backlash")
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
    for kind in TRANSMISSIONS:
        found = [effect.index for effect in robot.effects if effect.kind == kind]
        if len(set(found)) != len(found):
            raise InputError(
                f"joint {1 + max(found, key=found.count)} has two {kind} effects; expected one"
            )
        joints |= set(found)
    return tuple(sorted(joints))


def elastic_data(robot: Robot) -> Array:
    """Stiffness [Nm/rad], damping [Nm s/rad], rotor inertia [kg m2] and gap [rad] of each such
    joint, shape (k, 4)."""
    rows = []
    for j in elastic_joints(robot):
        found = {
            e.kind: e.parameters()
            for e in robot.effects
            if e.kind in TRANSMISSIONS and e.index == j
        }
        rotors = [e for e in robot.effects if e.kind == "rotor_inertia" and e.index == j]
        # the damping ratio is that of the link on its spring, the motor held
        link = float(Model(robot.bare()).mass_matrix(np.zeros(robot.n))[j, j])
        inertia = sum(float(e.coefficients()[0]) for e in rotors) if rotors else ROTOR_SHARE * link
        teeth = {
            "stiffness_Nm_rad": link * (2 * np.pi * TEETH_Hz) ** 2,
            "damping_ratio": TEETH_DAMPING,
        }
        spring = found.get("elastic_joint", teeth)
        stiffness = spring["stiffness_Nm_rad"]
        ratio = spring["damping_ratio"]
        gap = found.get("transmission_backlash", {"gap_rad": 0.0})["gap_rad"]
        rows.append([stiffness, 2 * ratio * np.sqrt(stiffness * link), inertia, gap])
    return np.array(rows, dtype=float).reshape(-1, 4)


def twist(load: Array, data: Array) -> Array:
    """q - l at rest under the loads [Nm] of the elastic joints, shape (k,) [rad]."""
    return load / data[:, 0] + 0.5 * data[:, 3] * np.sign(load)


def links_only(robot: Robot) -> Robot:
    """The robot without its springs and the rotors behind them: what the springs drive."""
    soft = elastic_joints(robot)
    kept = tuple(
        e
        for e in robot.effects
        if e.kind not in TRANSMISSIONS and not (e.kind == "rotor_inertia" and e.index in soft)
    )
    return robot.model_copy(update={"effects": kept})
