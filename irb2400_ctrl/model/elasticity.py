"""Elastic transmissions with motor and link apart: which joints, and their numbers.

A joint with an `elastic_joint` effect has two angles, that of its motor q and that of its link l:

    J qdd_motor + friction = tau - s,    s = k (q - l) + d (qd - ld) drives the link,

J the rotor's inertia reflected to the joint (`rotor_inertia` on that joint). Encoder, controller and dry friction are
on the motor's side; the tool hangs on the link's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.model import Model
from irb2400_ctrl.robot import Robot

Array = NDArray[np.float64]

ROTOR_SHARE = 0.1
"""assumption where a robot names an elastic joint but no rotor inertia: this share of the axis' inertia in the home
pose; not published for this robot"""


def elastic_joints(robot: Robot) -> tuple[int, ...]:
    """Zero-based numbers of the joints with an elastic transmission, in order."""
    found = [effect.index for effect in robot.effects if effect.kind == "elastic_joint"]
    if len(set(found)) != len(found):
        raise InputError(f"joint {1 + max(found, key=found.count)} has two elastic_joint effects; expected one")
    return tuple(sorted(found))


def elastic_data(robot: Robot) -> Array:
    """Stiffness [Nm/rad], damping [Nm s/rad] and rotor inertia [kg m2] of each elastic joint, shape (k, 3)."""
    rows = []
    for j in elastic_joints(robot):
        effect = next(e for e in robot.effects if e.kind == "elastic_joint" and e.index == j)
        rotors = [e for e in robot.effects if e.kind == "rotor_inertia" and e.index == j]
        # the damping ratio is that of the link on its spring, the motor held
        bare = robot.model_copy(update={"effects": tuple(e for e in robot.effects if e.acts == "parameters")})
        link = float(Model(bare).mass_matrix(np.zeros(robot.n))[j, j])
        inertia = sum(float(e.coefficients()[0]) for e in rotors) if rotors else ROTOR_SHARE * link
        stiffness, ratio = (effect.parameters()[name] for name in ("stiffness_Nm_rad", "damping_ratio"))
        rows.append([stiffness, 2 * ratio * np.sqrt(stiffness * link), inertia])
    return np.array(rows, dtype=float).reshape(-1, 3)


def links_only(robot: Robot) -> Robot:
    """The robot without its springs and the rotors behind them: what the springs drive."""
    soft = elastic_joints(robot)
    kept = tuple(
        e for e in robot.effects if e.kind != "elastic_joint" and not (e.kind == "rotor_inertia" and e.index in soft)
    )
    return robot.model_copy(update={"effects": kept})
